// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "batch/close/history_update.h"
#include "batch/state/run_plan.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"

namespace nonio::batch {

/// Does one shard of a planned run. The result contains the campaigns in the list of the shard;
/// those that are still `todo` at the end are left to the merge. Neither the register nor the key
/// is needed. Several processes may do the same shard, at once or one after the other, because all
/// of them write the same bytes.
RunResult run_shard(const RunOptions& options, const RunEvents& events);

/// Writes the plan with the lists of the shards after the survey. The first `own_notes` notes of
/// `run` are not stored in the plan. The run remains in progress.
Expected<void> plan_shards(const RunOptions& options, const reading::Context& context,
                           const RunState& state, bool register_read, std::size_t own_notes,
                           RunResult& run);

/// Fills `run` with the campaigns of the plan and the results of the shards, in place of a survey.
/// An error names shards that have not reported and campaigns whose results are missing.
Expected<void> gather(const RunOptions& options, const RunPlan& plan, RunResult& run);

/// Enters into the register why campaigns that failed in a shard got no certificate.
Expected<void> note_failures(const RunOptions& options, const reading::Context& context,
                             const RunResult& run, bool can_sign);

}  // namespace nonio::batch
