// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "campaign/reading/context.h"

namespace nonio::batch {

/// Stores failed results for campaigns that the survey refused; good results of an earlier run are
/// kept instead. Several campaigns with one id share a folder, so only the first of them is stored.
void store_refused(const RunOptions& options, const reading::Context& context, const RunState& run,
                   const RunEvents& events, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
