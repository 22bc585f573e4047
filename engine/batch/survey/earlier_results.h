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

/// Results whose id no manifest states.
struct EarlierResult {
  std::string id, folder;
  std::uint64_t run = 0;
  bool failed = false;
};

/// Index of the ids that manifests state. It contains positions of four bytes to save memory.
class ClaimedIds {
 public:
  explicit ClaimedIds(const std::vector<CampaignState>& campaigns);
  bool contains(std::string_view id) const;

 private:
  const std::vector<CampaignState>& campaigns_;
  std::vector<std::uint32_t> by_id_;
};

/// Returns the results in `out` whose id is not in `claimed`, sorted by id. An error if the folder
/// cannot be listed.
Expected<std::vector<EarlierResult>> unclaimed_results(const std::filesystem::path& out,
                                                       const ClaimedIds& claimed);

/// Returns the campaigns that no longer exist. Failed results of a folder whose campaign has
/// another id are only noted. The first `ordered` campaigns must be sorted by folder.
std::vector<Vanished> vanished_of(const std::vector<EarlierResult>& earlier,
                                  const std::vector<CampaignState>& campaigns, std::size_t ordered,
                                  const std::vector<SiteWalk::Unlisted>& unlisted,
                                  const std::filesystem::path& out,
                                  std::vector<std::string>& notes);

}  // namespace nonio::batch
