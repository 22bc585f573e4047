// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Finds files of readings that several campaigns contain and stores the other campaign with the
/// smallest id in `twins`. `campaigns` must be sorted by id; their `readings` are cleared.
void find_twins(std::vector<CampaignState>& campaigns);

/// Returns the first 64 bits of the SHA-256 of each shared file and the id of the other campaign,
/// sorted.
reading::Twins twins_of(const CampaignState& campaign, const std::vector<CampaignState>& all);

/// Returns the shared files of readings that the inputs of a record state.
reading::Twins twins_of(const reading::Inputs& inputs);

}  // namespace nonio::batch
