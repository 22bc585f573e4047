// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "campaign/reading/context.h"

namespace nonio::batch {

/// What the survey has failed: a good result of an earlier run stays, else there is one that states
/// what is wrong. Several campaigns with one id claim one folder.
void store_refused(const RunOptions& options, const reading::Context& context, const RunState& run,
                   const RunEvents& events, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
