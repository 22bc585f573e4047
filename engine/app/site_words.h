// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "campaign/config/terminal_words.h"
#include "common.h"

namespace nonio::app {

/// The words of the terminal: English until the site is known, then its language. It keeps copies of
/// the words alone, since the templates of a run end with it. Not copyable.
class SiteWords {
 public:
  explicit SiteWords(const Common& common);
  SiteWords(const SiteWords&) = delete;
  SiteWords& operator=(const SiteWords&) = delete;

  void take(const config::TerminalWords& words);
  const config::TerminalWords& get() const { return *words_; }

 private:
  Templates templates_{};
  std::optional<config::TerminalWords> words_{};
};

}  // namespace nonio::app
