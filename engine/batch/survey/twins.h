// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Files of readings that several campaigns have: each campaign gets the one with the smallest id
/// that is not its own. Campaigns are in the order of their ids; takes their `readings`. One sort,
/// whatever is shared.
void find_twins(std::vector<CampaignState>& campaigns);

/// As the evaluation requires them, in order.
reading::Twins twins_of(const CampaignState& campaign, const std::vector<CampaignState>& all);

/// Of a record: what the run knew when it was written.
reading::Twins twins_of(const reading::Inputs& inputs);

}  // namespace nonio::batch
