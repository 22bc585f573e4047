// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/config/site_logs.h"
#include "laboratory/store/identity.h"
#include "nonio/sdk/history.h"

/// Computes the machine's history that a campaign's report shows, from campaigns up to its own day.
/// The history depends neither on other machines, nor on later campaigns, nor on the run, so that
/// the order in which campaigns are evaluated does not change a report.
namespace nonio::assessment {

struct HistoryBasis {
  std::string campaign, day;
  store::NamedMachine machine;  ///< machine of the campaign; it has no name if the campaign states
                                ///< no machine
  std::vector<std::string> aliases;
  /// The machine's other campaigns up to `day`, ordered by day and id; each with the digest of its
  /// results.
  std::vector<std::pair<std::string, std::string>> campaigns;
  std::vector<config::Event> events;  ///< events of the machine up to `day`
  int months = 0;                     ///< interval of the site's rule in months; 0: there is no
                                      ///< rule
  /// Digest of all these data; the campaign's own results are not included.
  std::string sha256{};
};

/// Returns the bases of those campaigns that the store contains. An error if no store of this
/// version exists. Reads the list of campaigns and no results.
Expected<std::vector<HistoryBasis>> history_bases(const std::filesystem::path& out,
                                                  const std::vector<std::string>& campaigns);

/// Reads the results of one machine and computes the history, which has no series if the campaign
/// states no machine or no valid day.
Expected<HistorySoFar> history_so_far(const std::filesystem::path& out, const HistoryBasis& basis);

}  // namespace nonio::assessment
