// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/manifest.h"

/// Entries that people write about machines: SITE/events.toml, acknowledged.toml, forgotten.toml.
namespace nonio::config {

inline constexpr const char* events_name = "events.toml";
inline constexpr const char* acknowledged_name = "acknowledged.toml";
inline constexpr const char* forgotten_name = "forgotten.toml";

/// Whether a path below the site is a file or folder of the site itself, not of a campaign.
bool is_site_part(std::string_view path);

struct Event {
  std::string date, machine, axis, kind, text, by;  ///< `axis` is empty for the whole machine
  std::uint64_t line = 0;
  /// Whether it concerns the axis; empty: the whole machine. An event of X concerns the sides X1
  /// and X2 of a gantry.
  bool concerns(const std::string& of) const;
};

struct Acknowledgement {
  std::string date, finding, machine, axis, quantity, until;
  /// Value of the quantity on `date` and its U, in the unit of the quantity.
  std::optional<double> value{}, U{};
  std::string by, why;
  std::uint64_t line = 0;
};

/// Withdraws all earlier acknowledgements in the file that have the same finding, machine, axis and
/// quantity.
struct Withdrawal {
  std::string date, finding, machine, axis, quantity, by, why;
  std::uint64_t line = 0;
};

struct Forgotten {
  std::string date;
  std::string campaign;  ///< id of a campaign, or a path that fulfills `is_site_part`
  std::string by, why;
  std::uint64_t line = 0;
};

struct SiteLogs {
  std::vector<Event> events{};
  std::vector<Acknowledgement> acknowledged{};
  std::vector<Forgotten> forgotten{};
};

Checked<std::vector<Event>> parse_events(std::string_view text, const std::string& file);
/// Returns the acknowledgements that were not withdrawn; they may have expired.
Checked<std::vector<Acknowledgement>> parse_acknowledged(std::string_view text,
                                                         const std::string& file);
Checked<std::vector<Forgotten>> parse_forgotten(std::string_view text, const std::string& file);

Checked<SiteLogs> read_site_logs(const std::filesystem::path& site);

/// Appends an entry and leaves the rest of the file, including comments, unchanged. Nothing is
/// written if the file has errors, would have errors with the entry, or is being written by another
/// process.
Checked<void> add_event(const std::filesystem::path& site, const Event& event);
Checked<void> add_acknowledgement(const std::filesystem::path& site, const Acknowledgement& known);
/// Returns an error without a valid acknowledgement to withdraw.
Checked<void> add_withdrawal(const std::filesystem::path& site, const Withdrawal& withdrawal);
Checked<void> add_forgotten(const std::filesystem::path& site, const Forgotten& forgotten);

}  // namespace nonio::config
