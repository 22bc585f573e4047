// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "campaign/config/terminal_words.h"
#include "common.h"

namespace nonio::app {

/// Returns the language of the nearest folder at or above the path that contains a site, the
/// results of a campaign or those of a run; English without such a folder.
std::string language_at(const std::filesystem::path& path);

/// Texts for the terminal: English until the site is read, then in the language of the site. The
/// texts are copied, because the templates of a run are destroyed at its end.
class SiteWords {
 public:
  /// Uses English if there are no texts in `language`. Reads the files terminal and site of the
  /// words, and the file `more`.
  explicit SiteWords(const Common& common, const std::string& language = "en",
                     const std::string& more = "site");
  SiteWords(const SiteWords&) = delete;
  SiteWords& operator=(const SiteWords&) = delete;

  void take(const config::TerminalWords& words);
  const config::TerminalWords& get() const { return *words_; }

 private:
  Templates templates_{};
  std::optional<config::TerminalWords> words_{};
};

}  // namespace nonio::app
