// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

/// A campaign that measured the same axis of the same machine later.
struct LaterCampaign {
  std::filesystem::path folder;
  std::string id, date, purpose;
};

/// Returns the campaigns of this machine and axis with readings and a later date, or with the same
/// date and the purpose "check"; sorted by date. If the campaign belongs to no site, only the
/// folders next to it are searched. Manifests that cannot be read are skipped; empty if this
/// campaign states no date.
std::vector<LaterCampaign> later_campaigns(const OpenCampaign& open, const std::string& axis);

}  // namespace nonio::app
