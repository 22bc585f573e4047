// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "campaign/config/site_logs.h"
#include "nonio/sdk/error.h"

namespace nonio::store {

inline constexpr const char* store_name = "history.sqlite";

/// Data of the site apart from its campaigns.
struct SiteRecords {
  config::SiteLogs logs{};
  std::vector<config::Alias> aliases{};
  std::vector<config::Event> of_records{};  ///< tables that were loaded into a control, from the
                                            ///< records of the machines
  std::vector<config::DueRule> due{};
};

struct Updated {
  std::uint64_t evaluations = 0;  ///< number of evaluations added
  bool rebuilt = false;
  std::vector<std::string> left_out{};  ///< campaigns whose results cannot be read, each with the
                                        ///< reason
};

/// Adds new evaluations of these campaigns to the store, in one transaction. A store that is
/// missing, damaged, of an older version, or inconsistent with the results is rebuilt from all
/// results. `behind`: whether the store may lack results of an earlier run, so that it is rebuilt
/// too. `alive` is called repeatedly.
Expected<Updated> update(const std::filesystem::path& out, bool behind,
                         std::vector<std::string> campaigns, const SiteRecords& records,
                         const std::function<void()>& alive);

/// Rebuilds the store from the files of the output folder alone, in one transaction. The rows are
/// the same as those that `update` would write.
Expected<Updated> rebuild(const std::filesystem::path& out, const SiteRecords& records,
                          const std::function<void()>& alive);

/// Returns the run up to which the store contains all results, noted in OUT/.nonio. None while
/// results may be newer than the store.
Expected<std::optional<std::uint64_t>> known_run(const std::filesystem::path& out);
/// Removes the note of the run up to which the store is complete. Has to be called before the first
/// result is stored.
Expected<void> forget_known_run(const std::filesystem::path& out);
/// Notes the run up to which the store contains all results. Has to be called when the store
/// contains all results of the run.
Expected<void> note_known_run(const std::filesystem::path& out, std::uint64_t run);

}  // namespace nonio::store
