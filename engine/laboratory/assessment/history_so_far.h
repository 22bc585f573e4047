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

/// The machine's history that a campaign's report shows: of the campaigns up to its own day, out of
/// the store. It depends on no other machine, on nothing later and on no run, so that the same
/// results give the same report in any order.
namespace nonio::assessment {

/// From what such a history is made.
struct HistoryBasis {
  std::string campaign, day;
  store::NamedMachine machine;  ///< without a name: the campaign states none
  std::vector<std::string> aliases;
  /// The machine's other campaigns up to that day, by day and id; with the digest of their results.
  std::vector<std::pair<std::string, std::string>> campaigns;
  std::vector<config::Event> events;  ///< up to that day
  int months = 0;                     ///< interval of the site's rule; 0: there is none
  /// Of all this, and not of the campaign's own results.
  std::string sha256{};
};

/// Of these campaigns, those that the store knows. An error if there is no store that this program
/// reads. One look at the list of campaigns, and at no result.
Expected<std::vector<HistoryBasis>> history_bases(const std::filesystem::path& out,
                                                  const std::vector<std::string>& campaigns);

/// Reads the results of one machine.
Expected<HistorySoFar> history_so_far(const std::filesystem::path& out, const HistoryBasis& basis);

}  // namespace nonio::assessment
