// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"

namespace nonio::batch {

/// Marks the campaign whose folder or id is `options.only` as to be evaluated, and leaves all
/// others as the reopened run left them. Returns its id; an error if no campaign, or more than one,
/// matches.
Expected<std::string> leave_only(const RunOptions& options, const RunState& state, RunResult& run);

/// If the run is reopened, removes campaigns that were added to the site after it; the next run
/// evaluates them.
void leave_out_new(const RunState& state, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
