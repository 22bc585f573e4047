// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"

namespace nonio::batch {

/// Marks the campaign with the folder or id `options.only` for evaluation and restores the outcome
/// of all others from their records. Returns its id. An error unless exactly one campaign matches.
Expected<std::string> leave_only(const RunOptions& options, const RunState& state, RunResult& run);

/// Removes campaigns that were added to the site after the reopened run; the next run evaluates
/// them.
void leave_out_new(const RunState& state, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
