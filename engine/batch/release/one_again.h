// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"

namespace nonio::batch {

/// Marks one campaign of a reopened run as to be evaluated and leaves all others as the run left
/// them. Returns its id; an error if no campaign, or more than one, has that folder or id.
Expected<std::string> leave_only(const RunOptions& options, const RunState& state, RunResult& run);

/// Removes campaigns that were added after the reopened run; the next run evaluates them.
void leave_out_new(const RunState& state, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
