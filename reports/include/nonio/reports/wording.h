// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/settings.h"

namespace nonio::reports {

/// The words of templates/words/<language>/<file>.toml, of the first of some files that has them. A
/// word that is missing, or that has a place without a value, is recorded, and the document then
/// fails.
class Wording {
 public:
  using Places = std::initializer_list<std::pair<std::string_view, std::string_view>>;

  Wording(const Templates&, std::string language, std::vector<std::string> files);

  const std::string& language() const { return language_; }
  std::string get(std::string_view key) const;
  /// With `{name}` replaced.
  std::string get(std::string_view key, Places places) const;
  /// `otherwise` where there is no word: for names that other plugins make.
  std::string get_or(std::string_view key, std::string otherwise) const;

  Expected<void> complete() const;

 private:
  const std::string* find(std::string_view key) const;
  std::vector<const Settings*> settings_;
  std::string language_, file_;  ///< of the last file, where a missing word is searched
  std::string absent_;           ///< a file that is missing
  mutable std::string complaint_;
};

/// Units and signs of a plugin's sentence as they are printed: "-8.1 um" becomes "−8.1 µm"; text
/// between backquotes (commands, keys) gets quotation marks.
std::string typeset(std::string_view sentence);

/// The same as HTML: text between backquotes is code.
std::string typeset_html(std::string_view sentence);

}  // namespace nonio::reports
