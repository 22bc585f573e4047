// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/settings.h"

namespace nonio::config {

/// What the terminal and summary.txt state, in the language of the site:
/// templates/words/<language>/terminal.toml, and English where a language has no text.
class TerminalWords {
 public:
  using Parts = std::vector<std::pair<std::string, std::string>>;

  TerminalWords(const Templates& templates, std::string language)
      : templates_(templates), language_(std::move(language)) {}

  /// The text of that name, each `{part}` replaced; the name itself if there is no such text.
  std::string operator()(std::string_view name, const Parts& parts = {}) const;
  /// The text `<name>.one` for a count of 1, else `<name>.many`; `{count}` is the count.
  std::string counted(std::string_view name, std::size_t count, Parts parts = {}) const;
  /// A fixed text of the program (a reason, a decision) in the language; itself if it has no entry.
  std::string of(std::string_view list, const std::string& text) const;

  /// A number with the decimal sign of the language.
  std::string number(std::string text) const;

  const std::string& language() const { return language_; }
  const Templates& templates() const { return templates_; }

 private:
  std::string text_of(const std::string& name) const;

  const Templates& templates_;
  std::string language_;
};

}  // namespace nonio::config
