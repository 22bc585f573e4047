// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/close/history_update.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "batch/workers/runner.h"

namespace nonio::batch {

/// Adds the campaigns `done` to the history, or rebuilds the history if it is not complete up to
/// the run `known`. If the store cannot be written, the run does not fail: the error is noted in
/// `run`, and the next run rebuilds the store.
void write_history(RunResult& run, HistoryUpdate& history, std::uint64_t known,
                   const std::vector<std::string>& done,
                   const Expected<store::SiteRecords>& records, const RunEvents& events);

/// Writes reports again that show another history of the machine than the store contains, so that
/// the order in which campaigns are evaluated has no effect. Returns false if a stop was requested;
/// any other failure is noted in `run`, and the next run writes the reports. `only`: the campaign
/// of a reopened run; reports of other campaigns are left to the next run.
bool show_histories(const RunOptions& options, const RunEvents& events,
                    const reading::Context& context, const RunState& state, ReleaseDesk desk,
                    HistoryUpdate& history, const Expected<store::SiteRecords>& records,
                    const std::string& only, RunResult& run);

}  // namespace nonio::batch
