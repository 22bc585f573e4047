// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"

namespace nonio::batch {

/// Marks the campaign whose folder or id is `options.only` as to be evaluated, and restores the
/// outcome of all others in the reopened run. Returns the id of the campaign; an error if no
/// campaign, or more than one, matches.
Expected<std::string> leave_only(const RunOptions& options, const RunState& state, RunResult& run);

/// If the run is reopened, removes campaigns that were added to the site later; the next run
/// evaluates them.
void leave_out_new(const RunState& state, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
