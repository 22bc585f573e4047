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

/// Finds the campaigns whose documents show another history of their machine than the store
/// contains. A run evaluates them again after it has added its results to the store. The store is
/// not read if OUT/.nonio/histories notes that all documents are up to date, and the events,
/// aliases and calibration intervals have not changed since.
class ShownHistories {
 public:
  ShownHistories(const RunOptions& options, const reading::Context& context)
      : options_(options), context_(context) {}

  /// Has to be called before the first result of a run is stored. Notes that documents may show
  /// outdated histories until `end` is called.
  Expected<void> begin() const;
  /// Returns the history to be shown, by campaign id, for each campaign whose document shows
  /// another history. With `looked`, the store is read even if all documents are noted as up to
  /// date.
  Expected<std::map<std::string, assessment::HistoryBasis>> others(
      const std::vector<CampaignState>& campaigns, const store::SiteRecords& records,
      bool looked) const;
  /// Notes in OUT/.nonio/histories that all documents show the present history.
  Expected<void> end(const std::vector<CampaignState>& campaigns,
                     const store::SiteRecords& records) const;

 private:
  const RunOptions& options_;
  const reading::Context& context_;
};

}  // namespace nonio::batch
