// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

/// A campaign of the site that measured an axis of the same machine.
struct LaterCampaign {
  std::filesystem::path folder;
  std::string id, date, purpose;
};

/// The campaigns of this machine and axis with readings and a later date, or of the same date with
/// the purpose "check"; by date. Of a site
/// without site.toml and machines/ only those in the same folder. Manifests that cannot be read are left out.
std::vector<LaterCampaign> later_campaigns(const OpenCampaign& open, const std::string& axis);

}  // namespace nonio::app
