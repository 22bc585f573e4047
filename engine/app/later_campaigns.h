// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

struct LaterCampaign {
  std::filesystem::path folder;
  std::string id, date, purpose;
};

/// Returns the campaigns with readings of the same machine and axis and a later date, or the same
/// date and purpose "check", sorted by date. Searches the site or, without a site, the folders with
/// the same parent. Unreadable manifests are skipped. Empty if this campaign has no date.
std::vector<LaterCampaign> later_campaigns(const OpenCampaign& open, const std::string& axis);

}  // namespace nonio::app
