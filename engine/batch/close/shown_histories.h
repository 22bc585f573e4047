// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "batch/state/run_result.h"
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

}  // namespace nonio::batch
