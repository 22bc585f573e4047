// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/survey/site_walk.h"

namespace nonio::batch {

/// Results in the output folder under an id that no manifest of this run has, by id.
struct EarlierResult {
  std::string id, folder;  ///< folder: as text, of the campaign, relative to the site
  std::uint64_t run = 0;
  bool failed = false;
};

/// The campaigns whose manifests give an id, to be found by it. Keeps their positions, four bytes each.
class ClaimedIds {
 public:
  explicit ClaimedIds(const std::vector<CampaignState>& campaigns);
  bool contains(std::string_view id) const;

 private:
  const std::vector<CampaignState>& campaigns_;
  std::vector<std::uint32_t> by_id_;
};

/// An error if the folder cannot be listed.
Expected<std::vector<EarlierResult>> unclaimed_results(const std::filesystem::path& out,
                                                       const ClaimedIds& claimed);

/// What existed before and does not exist in this run. Failed results of a folder that is there
/// under another id are leftovers, and only noted. The first `ordered` campaigns are in the order
/// of their folders.
std::vector<Vanished> vanished_of(const std::vector<EarlierResult>& earlier,
                                  const std::vector<CampaignState>& campaigns, std::size_t ordered,
                                  const std::vector<SiteWalk::Unlisted>& unlisted,
                                  const std::filesystem::path& out,
                                  std::vector<std::string>& notes);

}  // namespace nonio::batch
