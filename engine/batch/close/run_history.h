// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/close/history_update.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "batch/workers/runner.h"

namespace nonio::batch {

/// If the index cannot be written, the run does not fail: it is made again from the results.
void write_history(RunResult& run, HistoryUpdate& history, std::uint64_t known,
                   const std::vector<std::string>& done,
                   const Expected<store::SiteRecords>& records, const RunEvents& events);

/// Reports that show another history of their machine than the store has by now are written again:
/// whatever the order in which campaigns came, each sees all that its day knew. False if it was
/// interrupted.
/// `only`: the campaign of a run that is reopened; reports of others are left to the next run.
bool show_histories(const RunOptions& options, const RunEvents& events,
                    const reading::Context& context, const RunState& state, ReleaseDesk desk,
                    HistoryUpdate& history, const Expected<store::SiteRecords>& records,
                    const std::string& only, RunResult& run);

}  // namespace nonio::batch
