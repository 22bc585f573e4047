// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::assessment {

/// What a run itself knows and the history does not.
struct LastRun {
  struct Failed {
    std::string campaign, folder;  ///< folder: relative to the site, as text
    std::string message;           ///< with file and line
    std::string since;             ///< day of the first run with this failure; empty: this run
  };
  struct Vanished {
    std::string campaign, folder;
    std::uint64_t last_seen_run = 0;
    std::string why;  ///< what is there instead
  };
  std::uint64_t run = 0;
  std::string date;  ///< of the run, YYYY-MM-DD: the only clock
  std::uint64_t campaigns = 0, done = 0, unchanged = 0;
  std::vector<Failed> failed{};        ///< by campaign
  std::vector<Vanished> vanished{};    ///< by campaign; without those that were removed on purpose
  std::vector<std::string> issued{};   ///< numbers of certificates
  std::vector<std::string> waiting{};  ///< campaigns whose drafts wait for a release
  std::string language = "en";         ///< of the site
  std::string history_error{};         ///< the store does not contain this run
};

/// Of the last complete run, from OUT/summary.json. An error if there is none.
Expected<LastRun> last_run_in(const std::filesystem::path& out);

}  // namespace nonio::assessment
