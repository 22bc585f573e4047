// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "batch/close/history_update.h"
#include "batch/state/night.h"
#include "batch/state/night_plan.h"
#include "batch/state/night_state.h"

namespace nonio::batch {

/// One shard of a planned night: `Night::campaigns` are those of its list; what is still to do at
/// the end is left to the merge. It needs neither the register nor the key. Several processes may
/// do the same shard, at once or one after the other, and leave the same bytes.
Night run_shard(const RunOptions& options, const RunEvents& events);

/// After the survey: the lists of the shards. The run stays open.
Expected<void> plan_shards(const RunOptions& options, const reading::Context& context,
                           const NightState& state, bool register_read, std::size_t own_notes,
                           Night& night);

/// What the survey found and the shards have made of it, in place of a survey. An error names the
/// shards that have not reported and campaigns whose results are not there.
Expected<void> gather(const RunOptions& options, const NightPlan& plan, Night& night);

/// In the register: why campaigns that failed in a shard were not issued.
Expected<void> note_failures(const RunOptions& options, const reading::Context& context,
                             const Night& night, bool can_sign);

}  // namespace nonio::batch
