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
/// contains. A run calls this when the store contains its results, and evaluates those campaigns
/// again. If OUT/.nonio/histories notes that all documents are up to date and no entry changed
/// since, the store is not read.
class ShownHistories {
 public:
  ShownHistories(const RunOptions& options, const reading::Context& context)
      : options_(options), context_(context) {}

  /// Has to be called before the first result of a run is stored. Notes that documents may show
  /// outdated histories until `end` is called.
  Expected<void> begin() const;
  /// Returns, by campaign, the history that its document should show, for campaigns whose document
  /// shows another one. `looked`: read the store even if all documents are noted as up to date.
  Expected<std::map<std::string, assessment::HistoryBasis>> others(
      const std::vector<CampaignState>& campaigns, const store::SiteRecords& records,
      bool looked) const;
  /// Notes that all documents show the present history.
  Expected<void> end(const std::vector<CampaignState>& campaigns,
                     const store::SiteRecords& records) const;

 private:
  const RunOptions& options_;
  const reading::Context& context_;
};

}  // namespace nonio::batch
