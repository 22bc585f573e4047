// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/batch/run.h"
#include "host/batch/site_walk.h"

namespace nonio::host::batch {

/// Results in the output folder under an id that no manifest gives tonight, by id.
struct EarlierResult {
  std::string id, folder;  ///< folder: as text, of the campaign, relative to the site
  std::uint64_t night = 0;
  bool failed = false;
};

/// `campaigns`: those with `named_by_folder` do not count. An error if the folder cannot be listed.
Expected<std::vector<EarlierResult>> unclaimed_results(const std::filesystem::path& out,
                                                       const std::vector<CampaignState>& campaigns);

/// What of it was there before and is not there tonight. Failed results of a folder that is there
/// under another id are leftovers, and only noted.
std::vector<Vanished> vanished_of(const std::vector<EarlierResult>& earlier,
                                  const std::vector<CampaignState>& campaigns,
                                  const std::vector<SiteWalk::Unlisted>& unlisted,
                                  const std::filesystem::path& out,
                                  std::vector<std::string>& notes);

}  // namespace nonio::host::batch
