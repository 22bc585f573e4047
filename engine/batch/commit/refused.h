// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "campaign/reading/context.h"

namespace nonio::batch {

/// Stores failed results of campaigns that the survey rejected, but keeps good results of an
/// earlier run. Of several campaigns with the same id only the first is stored, because they share
/// a folder.
void store_refused(const RunOptions& options, const reading::Context& context, const RunState& run,
                   const RunEvents& events, std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
