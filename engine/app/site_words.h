// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "campaign/config/terminal_words.h"
#include "common.h"

namespace nonio::app {

/// Words for output on the terminal: English until the site is known, then in its language. It
/// contains copies of the words, since the templates end with the run. Not copyable.
class SiteWords {
 public:
  /// English is used if the language has no words, or is empty.
  explicit SiteWords(const Common& common, const std::string& language = "en");
  SiteWords(const SiteWords&) = delete;
  SiteWords& operator=(const SiteWords&) = delete;

  void take(const config::TerminalWords& words);
  const config::TerminalWords& get() const { return *words_; }

 private:
  Templates templates_{};
  std::optional<config::TerminalWords> words_{};
};

}  // namespace nonio::app
