// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "batch/close/history_update.h"
#include "batch/state/run_plan.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"

namespace nonio::batch {

/// Evaluates the campaigns of one shard without register and key. Campaigns that are still `todo`
/// are left to the merge. Several processes may evaluate the same shard, also at the same time,
/// because all of them write the same bytes.
RunResult run_shard(const RunOptions& options, const RunEvents& events);

/// Writes the plan and the lists of the shards after the survey. The plan excludes the first
/// `own_notes` notes of `run`.
Expected<void> plan_shards(const RunOptions& options, const reading::Context& context,
                           const RunState& state, bool register_read, std::size_t own_notes,
                           RunResult& run);

/// Sets the campaigns of `run` from the plan and the results of the shards. An error names shards
/// without a report and campaigns without results.
Expected<void> gather(const RunOptions& options, const RunPlan& plan, RunResult& run);

/// Enters into the register why campaigns that failed in a shard have no certificate.
Expected<void> note_failures(const RunOptions& options, const reading::Context& context,
                             const RunResult& run, bool can_sign);

}  // namespace nonio::batch
