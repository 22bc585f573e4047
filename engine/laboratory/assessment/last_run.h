// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::assessment {

/// Facts about the last run that the history does not contain.
struct LastRun {
  struct Failed {
    std::string campaign, folder;  ///< id of the campaign, and its folder relative to the site, as
                                   ///< text
    std::string message;           ///< error message with file and line
    std::string since;             ///< day of the first run with this failure; empty: it is new in
                                   ///< this run
  };
  struct Vanished {
    std::string campaign, folder;
    std::uint64_t last_seen_run = 0;
    std::string why;  ///< what was found in place of the campaign
  };
  std::uint64_t run = 0;
  std::string date;  ///< date of the run, YYYY-MM-DD; used in place of a clock
  std::uint64_t campaigns = 0, done = 0, unchanged = 0;
  std::vector<Failed> failed{};        ///< sorted by campaign
  std::vector<Vanished> vanished{};    ///< sorted by campaign, without campaigns that were removed
                                       ///< on purpose
  std::vector<std::string> issued{};   ///< numbers of issued certificates
  std::vector<std::string> waiting{};  ///< campaigns whose drafts wait for approval
  std::string language = "en";
  /// why the store does not contain this run; empty: the store contains it
  std::string history_error{};
};

/// Reads the last complete run from OUT/summary.json. An error if there is none.
Expected<LastRun> last_run_in(const std::filesystem::path& out);

}  // namespace nonio::assessment
