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

/// Which campaigns show another history of their machine than the store has. A run calls this when
/// the store contains its results; then those campaigns are done again. Where nothing has changed
/// since all were right (by OUT/.nonio/histories), no history is looked at.
class ShownHistories {
 public:
  ShownHistories(const RunOptions& options, const reading::Context& context)
      : options_(options), context_(context) {}

  /// Before the first result is stored, if one is going to be.
  Expected<void> begin() const;
  /// By campaign. `looked`: whatever was noted before. Notes nothing.
  Expected<std::map<std::string, assessment::HistoryBasis>> others(
      const std::vector<CampaignState>& campaigns, const store::SiteRecords& records,
      bool looked) const;
  /// All are right.
  Expected<void> end(const std::vector<CampaignState>& campaigns,
                     const store::SiteRecords& records) const;

 private:
  const RunOptions& options_;
  const reading::Context& context_;
};

}  // namespace nonio::batch
