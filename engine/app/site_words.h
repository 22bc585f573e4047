// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "campaign/config/terminal_words.h"
#include "common.h"

namespace nonio::app {

/// The words of the terminal: English until the site is known, then its language. It keeps copies of
/// the words alone, since the templates of a run end with it. Not copyable.
class SiteWords {
 public:
  /// English where a language has no words, and of "".
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
