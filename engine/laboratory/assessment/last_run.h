// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::assessment {

/// Data of the last run that the history does not contain.
struct LastRun {
  struct Failed {
    std::string campaign, folder;  ///< id and folder relative to the site, as text
    std::string message;
    std::string since;  ///< date of the first run with this failure; empty if it is new
  };
  struct Vanished {
    std::string campaign, folder;
    std::uint64_t last_seen_run = 0;
    std::string why;
  };
  std::uint64_t run = 0;
  std::string date;  ///< YYYY-MM-DD; replaces the clock
  std::uint64_t campaigns = 0, done = 0, unchanged = 0;
  std::vector<Failed> failed{};          ///< sorted by campaign
  std::vector<Vanished> vanished{};      ///< sorted by campaign, without those removed on purpose
  std::vector<std::string> issued{};     ///< numbers of certificates
  std::vector<std::string> waiting{};    ///< campaigns whose drafts wait for approval
  std::set<std::string> out_of_force{};  ///< numbers of certificates no longer in force
  std::string language = "en";
  /// Reason why the store lacks this run.
  std::string history_error{};
};

/// Reads OUT/summary.json. An error if no run is complete.
Expected<LastRun> last_run_in(const std::filesystem::path& out);

}  // namespace nonio::assessment
