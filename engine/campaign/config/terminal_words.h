// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/settings.h"

namespace nonio::config {

/// Texts of the terminal and of summary.txt in the language of the site:
/// templates/words/<language>/terminal.toml; a missing text is taken from English.
class TerminalWords {
 public:
  using Parts = std::vector<std::pair<std::string, std::string>>;

  TerminalWords(const Templates& templates, std::string language)
      : templates_(templates), language_(std::move(language)) {}

  /// Returns the text of this name with each `{part}` replaced; the name itself if there is no
  /// text.
  std::string operator()(std::string_view name, const Parts& parts = {}) const;
  /// Returns the text `<name>.one` for a count of 1, otherwise `<name>.many`, with `{count}`
  /// replaced.
  std::string counted(std::string_view name, std::size_t count, Parts parts = {}) const;
  /// Returns the translation of a fixed text of the program (a reason, a decision), which the table
  /// `list` of the templates contains; returns the text unchanged if there is no entry.
  std::string of(std::string_view list, const std::string& text) const;

  /// Returns a number with the decimal sign of the language.
  std::string number(std::string text) const;

  const std::string& language() const { return language_; }
  const Templates& templates() const { return templates_; }

 private:
  std::string text_of(const std::string& name) const;

  const Templates& templates_;
  std::string language_;
};

}  // namespace nonio::config
