// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/state/night.h"
#include "batch/state/night_state.h"

namespace nonio::batch {

/// Of a night that is reopened: one campaign is to do, every other one stands as the night left it.
/// Its id; an error if no campaign has that folder or id.
Expected<std::string> leave_only(const RunOptions& options, const NightState& state, Night& night);

/// Campaigns that came after a night that is reopened are the next one's.
void leave_out_new(const NightState& state, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
