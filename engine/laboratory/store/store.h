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

struct SiteRecords {
  config::SiteLogs logs{};
  std::vector<config::Alias> aliases{};
  std::vector<config::Event> of_records{};  ///< loaded tables in the machine records
  std::vector<config::DueRule> due{};
};

struct Updated {
  std::uint64_t evaluations = 0;  ///< number of added evaluations
  bool rebuilt = false;
  std::vector<std::string> left_out{};  ///< campaigns whose results cannot be read, with the reason
};

/// Adds new evaluations of these campaigns in one transaction. Rebuilds a store that is missing,
/// damaged, of an older version or inconsistent with the results, or that may lack results of an
/// earlier run (`behind`). `alive` is called repeatedly as a sign of life.
Expected<Updated> update(const std::filesystem::path& out, bool behind,
                         std::vector<std::string> campaigns, const SiteRecords& records,
                         const std::function<void()>& alive);

/// Returns the run up to which the store is complete, from a note in OUT/.nonio. std::nullopt if
/// results may be newer than the store.
Expected<std::optional<std::uint64_t>> known_run(const std::filesystem::path& out);
/// Removes the note of `known_run`. Must be called before the first result is stored.
Expected<void> forget_known_run(const std::filesystem::path& out);
/// Writes the note of `known_run`. Must be called when the store contains all results of the run.
Expected<void> note_known_run(const std::filesystem::path& out, std::uint64_t run);

}  // namespace nonio::store
