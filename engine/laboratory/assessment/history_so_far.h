// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "campaign/config/site_logs.h"
#include "laboratory/store/identity.h"
#include "nonio/sdk/history.h"

/// Data for the machine history in a report, from campaigns up to the date of its campaign. Other
/// machines, later campaigns and the number of the run have no effect, so that the order of
/// evaluation does not change a report.
namespace nonio::assessment {

struct HistoryBasis {
  std::string campaign, day;
  store::NamedMachine machine;  ///< has no name if the campaign states no machine
  std::vector<std::string> aliases;
  /// Other campaigns of the machine up to `day`, ordered by date and id, with the digests of their
  /// results.
  std::vector<std::pair<std::string, std::string>> campaigns;
  std::vector<config::Event> events;  ///< up to `day`
  /// Calibration interval of the site in months; 0 without a rule.
  int months = 0;
  /// Digest of the other members.
  std::string sha256{};
};

/// Returns the bases of those campaigns that the store contains, without reading results. An error
/// if there is no store of this version.
Expected<std::vector<HistoryBasis>> history_bases(const std::filesystem::path& out,
                                                  const std::vector<std::string>& campaigns);

/// Reads the results of the machine and computes the history, which has no series if the campaign
/// states no machine or no valid date.
Expected<HistorySoFar> history_so_far(const std::filesystem::path& out, const HistoryBasis& basis);

}  // namespace nonio::assessment
