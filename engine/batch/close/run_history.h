// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/close/history_update.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "batch/workers/runner.h"

namespace nonio::batch {

/// Adds the campaigns `done` to the history, or rebuilds it if it is not complete up to the run
/// `known`. An error does not fail the run: it is noted in `run`, and the next run rebuilds the
/// history.
void write_history(RunResult& run, HistoryUpdate& history, std::uint64_t known,
                   const std::vector<std::string>& done,
                   const Expected<store::SiteRecords>& records, const RunEvents& events);

/// Writes reports again whose history of the machine is outdated, so that the order of evaluation
/// has no effect. Returns false if a stop was requested. Other errors are noted in `run`, and the
/// next run repeats the step. If `only` is not empty, other campaigns are left to the next run.
bool show_histories(const RunOptions& options, const RunEvents& events,
                    const reading::Context& context, const RunState& state, ReleaseDesk desk,
                    HistoryUpdate& history, const Expected<store::SiteRecords>& records,
                    const std::string& only, RunResult& run);

}  // namespace nonio::batch
