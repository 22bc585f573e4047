// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "batch/close/history_update.h"
#include "batch/state/run_plan.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"

namespace nonio::batch {

/// One shard of a planned run: `RunResult::campaigns` are those of its list; what is still to do at
/// the end is left to the merge. It needs neither the register nor the key. Several processes may
/// do the same shard, at once or one after the other, and leave the same bytes.
RunResult run_shard(const RunOptions& options, const RunEvents& events);

/// After the survey: the lists of the shards. The run stays open.
Expected<void> plan_shards(const RunOptions& options, const reading::Context& context,
                           const RunState& state, bool register_read, std::size_t own_notes,
                           RunResult& run);

/// What the survey found and the shards have made of it, in place of a survey. An error names the
/// shards that have not reported and campaigns whose results are missing.
Expected<void> gather(const RunOptions& options, const RunPlan& plan, RunResult& run);

/// In the register: why campaigns that failed in a shard were not issued.
Expected<void> note_failures(const RunOptions& options, const reading::Context& context,
                             const RunResult& run, bool can_sign);

}  // namespace nonio::batch
