// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/manifest.h"

/// Entries of people about machines: SITE/events.toml, acknowledged.toml, forgotten.toml.
namespace nonio::config {

inline constexpr const char* events_name = "events.toml";
inline constexpr const char* acknowledged_name = "acknowledged.toml";
inline constexpr const char* forgotten_name = "forgotten.toml";

/// Whether this is a file or folder of a site besides its campaigns, as a path below the site.
bool is_site_part(std::string_view path);

struct Event {
  std::string date, machine, axis, kind, text, by;  ///< axis: empty: the whole machine
  std::uint64_t line = 0;
};

struct Acknowledgement {
  std::string date, finding, machine, axis, quantity, until;
  std::optional<double> value{}, U{};  ///< of the quantity on that day, in its unit
  std::string by, why;
  std::uint64_t line = 0;
};

/// Takes back the acknowledgements above it that have the same four names.
struct Withdrawal {
  std::string date, finding, machine, axis, quantity, by, why;
  std::uint64_t line = 0;
};

struct Forgotten {
  std::string date;
  std::string campaign;  ///< or a path for which `is_site_part` holds
  std::string by, why;
  std::uint64_t line = 0;
};

struct SiteLogs {
  std::vector<Event> events{};
  std::vector<Acknowledgement> acknowledged{};
  std::vector<Forgotten> forgotten{};
};

/// All that is wrong with a file at once, each with its line.
Checked<std::vector<Event>> parse_events(std::string_view text, const std::string& file);
/// Those that count: what was withdrawn is left out.
Checked<std::vector<Acknowledgement>> parse_acknowledged(std::string_view text,
                                                         const std::string& file);
Checked<std::vector<Forgotten>> parse_forgotten(std::string_view text, const std::string& file);

/// The three files of a site; a missing one is empty.
Checked<SiteLogs> read_site_logs(const std::filesystem::path& site);

/// Adds an entry at the end of the file, after all that it contains, comments included; a missing
/// file is made. Refused, and nothing written, if the file has errors, if it would have errors with
/// the entry, or if another process writes it meanwhile.
Checked<void> add_event(const std::filesystem::path& site, const Event& event);
Checked<void> add_acknowledgement(const std::filesystem::path& site, const Acknowledgement& known);
/// Refused if nothing that counts has its names.
Checked<void> add_withdrawal(const std::filesystem::path& site, const Withdrawal& withdrawal);
Checked<void> add_forgotten(const std::filesystem::path& site, const Forgotten& forgotten);

}  // namespace nonio::config
