// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Finds files of readings that several campaigns have, and notes for each campaign the smallest id
/// of another campaign with the file. Campaigns must be in the order of their ids; their `readings`
/// are empty afterwards.
void find_twins(std::vector<CampaignState>& campaigns);

/// Returns the shortened digest of each file of readings that another campaign contains too, with
/// the id of that campaign. The list is sorted by digest, as the evaluation requires.
reading::Twins twins_of(const CampaignState& campaign, const std::vector<CampaignState>& all);

/// Returns the files shared with other campaigns that the inputs in a record state.
reading::Twins twins_of(const reading::Inputs& inputs);

}  // namespace nonio::batch
