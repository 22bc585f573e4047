// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/config/site_logs.h"
#include "nonio/sdk/error.h"

namespace nonio::host::history {

inline constexpr const char* store_name = "history.sqlite";

/// What the site says beside its campaigns.
struct Told {
  config::SiteLogs logs{};
  std::vector<config::Alias> aliases{};
  std::vector<config::Event> of_records{};  ///< tables that came into a control
};

struct Night {
  std::uint64_t number = 0;  ///< 0: between nights
  std::uint64_t before = 0;  ///< the last night that ended; the store ought to know it
  bool behind = false;       ///< results may have changed that the store does not know of
};

struct Updated {
  std::uint64_t evaluations = 0;  ///< that are new in the store
  bool rebuilt = false;
  std::vector<std::string> left_out{};  ///< campaigns whose results cannot be read, and why
};

/// Adds to OUT/history.sqlite what these campaigns' results say since the night before, in one
/// transaction. A store that is not there, is damaged, of an older version, or does not know the
/// night before is made again from all results. `alive` is called now and then.
Expected<Updated> update(const std::filesystem::path& out, const Night& night,
                         std::vector<std::string> campaigns, const Told& told,
                         const std::function<void()>& alive);

/// Makes it again from nothing but what lies in the output folder: the same rows, in one
/// transaction.
Expected<Updated> rebuild(const std::filesystem::path& out, std::uint64_t night, const Told& told,
                          const std::function<void()>& alive);

/// Set before results are stored, taken away when the store knows them. While it is there, the
/// next update makes the store again.
Expected<void> mark_behind(const std::filesystem::path& out);
Expected<bool> is_behind(const std::filesystem::path& out);
void unmark_behind(const std::filesystem::path& out);

}  // namespace nonio::host::history
