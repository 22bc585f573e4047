// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "batch/workers/plugin_host.h"
#include "certificates/numbering.h"
#include "certificates/signer.h"
#include "laboratory/assessment/history_so_far.h"

namespace nonio::batch {

/// Called with all entries of the register as soon as it can be read. After an error no number is
/// assigned.
using NumbersCheck = std::function<Expected<void>(const std::vector<certificates::RegisterEntry>&)>;

/// What the workers need to issue certificates.
struct ReleaseDesk {
  certificates::Signer* signer = nullptr;              ///< process with the key; null: nothing is
                                                       ///< signed
  const certificates::Releasing* releasing = nullptr;  ///< the approval that is carried out; null
                                                       ///< in a run
  NumbersCheck recheck{};                              ///< check of the numbers as soon as the
                                                       ///< register can be read; empty: they were
                                                       ///< checked before
  PluginHost* plugins = nullptr;                       ///< starts the processes that evaluate
  /// History by campaign, for campaigns whose documents show it; others are evaluated without one.
  std::map<std::string, assessment::HistoryBasis> histories{};
  /// Whether register and key are on another host. Campaigns that need them are then left to the
  /// merge.
  bool elsewhere = false;
};

/// Evaluates every campaign that is to be evaluated, in worker processes. Returns false if a stop
/// was requested.
bool do_campaigns(const RunOptions& options, const RunEvents& events,
                  const reading::Context& context, const RunState& run, const ReleaseDesk& desk,
                  std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
