// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/settings.h"
#include "nonio/sdk/templates.h"

namespace nonio::reports {

/// Texts of templates/words/<language>/<file>.toml, from the first file that has the key. A missing
/// text, or a placeholder without a value, is recorded and makes `complete` fail.
class Wording {
 public:
  using Places = std::initializer_list<std::pair<std::string_view, std::string_view>>;

  Wording(const Templates&, std::string language, std::vector<std::string> files);

  const std::string& language() const { return language_; }
  std::string get(std::string_view key) const;
  /// Replaces each placeholder `{name}` by its value in `places`.
  std::string get(std::string_view key, Places places) const;
  /// `otherwise` is used if the text is missing, for names made by other plugins.
  std::string get_or(std::string_view key, std::string otherwise) const;

  Expected<void> complete() const;

 private:
  const std::string* find(std::string_view key) const;
  std::vector<const Settings*> settings_;
  std::string language_, file_;  ///< of the last file, for messages
  std::string absent_;           ///< name of the first missing file
  mutable std::string complaint_;
};

/// Typographic units and signs: "-8.1 um" becomes "−8.1 µm"; text in backquotes (commands, keys)
/// gets quotation marks.
std::string typeset(std::string_view sentence);

/// Like `typeset`, as HTML; text in backquotes is code.
std::string typeset_html(std::string_view sentence);

}  // namespace nonio::reports
