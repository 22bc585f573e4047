// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "batch/close/history_update.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "batch/workers/runner.h"
#include "campaign/reading/context.h"
#include "laboratory/assessment/history_so_far.h"
#include "laboratory/store/store.h"

namespace nonio::batch {

/// Finds campaigns whose documents contain an outdated history of their machine, which a run
/// evaluates again after it has updated the store. The store is not read if OUT/.nonio/histories
/// states that all documents are up to date for the present events, aliases and calibration
/// intervals.
class ShownHistories {
 public:
  ShownHistories(const RunOptions& options, const reading::Context& context)
      : options_(options), context_(context) {}

  /// Must be called before the first result of a run is stored. Until `end`, documents may be
  /// outdated.
  Expected<void> begin() const;
  /// Returns the present history, by campaign id, for each campaign whose document contains another
  /// one. `looked` forces the store to be read.
  Expected<std::map<std::string, assessment::HistoryBasis>> others(
      const std::vector<CampaignState>& campaigns, const store::SiteRecords& records,
      bool looked) const;
  /// Notes in OUT/.nonio/histories that all documents contain the present history.
  Expected<void> end(const std::vector<CampaignState>& campaigns,
                     const store::SiteRecords& records) const;

 private:
  const RunOptions& options_;
  const reading::Context& context_;
};

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
