// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"

namespace nonio::batch {

/// Of a run that is reopened: one campaign is to do, every other one stays as the run left it.
/// Its id; an error if no campaign has that folder or id.
Expected<std::string> leave_only(const RunOptions& options, const RunState& state, RunResult& run);

/// Campaigns that came after a run that is reopened belong to the next one.
void leave_out_new(const RunState& state, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
