// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/manifest.h"

/// How often effects were found on the machines of the laboratory: SITE/fleet.toml, counted from
/// the results of a run.
namespace nonio::config {

inline constexpr const char* fleet_name = "fleet.toml";

struct Fleet {
  struct Effect {
    std::string name;                ///< without its axis: "backlash"
    std::vector<std::string> found;  ///< ids of the campaigns in which it was found
    /// Median and spread (half the distance of the quartiles) of its sizes, in `unit`.
    double median = 0.0, spread = 0.0;
    std::string unit{};
  };
  struct Machines {
    std::string maker, model;            ///< empty: all machines
    std::vector<std::string> campaigns;  ///< ids of the campaigns in which effects were searched
    std::vector<Effect> effects;
  };
  std::string counted, from, until;  ///< day of the count; first and last day of a campaign
  std::vector<Machines> machines;
};

Checked<Fleet> parse_fleet(std::string_view text, const std::string& file);
std::string text_of(const Fleet& fleet);
/// Returns an empty count if the file does not exist or the site switches it off.
Checked<Fleet> read_fleet(const std::filesystem::path& site, const SiteFile& settings);

/// The counts for one search, without the campaigns that it explains, because evidence from the
/// same readings must not be used twice.
struct Priors {
  struct Of {
    std::size_t found = 0;
    double median = 0.0, spread = 0.0;
    std::string unit{};
  };
  std::string machines;  ///< maker and model; empty: all machines
  std::string counted, from, until;
  std::size_t campaigns = 0;
  std::map<std::string, Of> effects{};

  Of of(const std::string& effect) const;
  /// Share of the campaigns in which the effect is expected.
  double frequency(const std::string& effect) const;
};

/// Counts of the machines of this maker and model or, if these are too few, of all machines.
Priors priors_of(const Fleet& fleet, const Machine& machine,
                 const std::vector<std::string>& without);

}  // namespace nonio::config
