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

/// What the site states apart from its campaigns.
struct SiteRecords {
  config::SiteLogs logs{};
  std::vector<config::Alias> aliases{};
  std::vector<config::Event> of_records{};  ///< tables that came into a control
  std::vector<config::DueRule> due{};
};

struct Updated {
  std::uint64_t evaluations = 0;  ///< that are new in the store
  bool rebuilt = false;
  std::vector<std::string> left_out{};  ///< campaigns whose results cannot be read, and why
};

/// Adds to OUT/history.sqlite what is new in these campaigns' results, in one transaction. A store
/// that is missing, is damaged, of an older version, or does not fit the results is made again from
/// all of them; so is one that is `behind`. `alive` is called now and then.
Expected<Updated> update(const std::filesystem::path& out, bool behind,
                         std::vector<std::string> campaigns, const SiteRecords& records,
                         const std::function<void()>& alive);

/// Makes it again from the files of the output folder alone: the same rows, in one transaction.
Expected<Updated> rebuild(const std::filesystem::path& out, const SiteRecords& records,
                          const std::function<void()>& alive);

/// The run up to which the store contains all results, kept in OUT/.nonio. None while results may
/// be newer than the store.
Expected<std::optional<std::uint64_t>> known_run(const std::filesystem::path& out);
/// Before the first result is stored.
Expected<void> forget_known_run(const std::filesystem::path& out);
/// When the store knows them.
Expected<void> note_known_run(const std::filesystem::path& out, std::uint64_t run);

}  // namespace nonio::store
