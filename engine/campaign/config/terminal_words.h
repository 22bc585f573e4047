// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/templates.h"

namespace nonio::config {

/// Texts of terminal.toml in the language of the site. A missing text is taken from English.
class TerminalWords {
 public:
  using Parts = std::vector<std::pair<std::string, std::string>>;

  TerminalWords(const Templates& templates, std::string language)
      : templates_(templates), language_(std::move(language)) {}

  /// Returns the text with each `{part}` replaced, or the name itself without a text.
  std::string operator()(std::string_view name, const Parts& parts = {}) const;
  std::string counted(std::string_view name, std::size_t count, Parts parts = {}) const;
  /// Translates a fixed text with the table `list`; without an entry, returns the text unchanged.
  std::string of(std::string_view list, const std::string& text) const;

  std::string number(std::string text) const;

  const std::string& language() const { return language_; }
  const Templates& templates() const { return templates_; }

 private:
  std::string text_of(const std::string& name) const;

  const Templates& templates_;
  std::string language_;
};

}  // namespace nonio::config
