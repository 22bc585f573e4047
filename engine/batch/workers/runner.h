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

/// Called once with all entries when the register can be read. After an error no number is
/// assigned.
using NumbersCheck = std::function<Expected<void>(const std::vector<certificates::RegisterEntry>&)>;

struct ReleaseDesk {
  certificates::Signer* signer = nullptr;
  const certificates::Releasing* releasing = nullptr;  ///< approval of a certificate; null in a run
  NumbersCheck recheck{};                              ///< empty if the numbers were checked before
  PluginHost* plugins = nullptr;
  /// Machine histories by campaign id.
  std::map<std::string, assessment::HistoryBasis> histories{};
  /// Whether register and key are on another host, so that campaigns that need them are left to the
  /// merge.
  bool elsewhere = false;
};

/// Evaluates the campaigns with the action `todo` in worker processes. Returns false if a stop was
/// requested.
bool do_campaigns(const RunOptions& options, const RunEvents& events,
                  const reading::Context& context, const RunState& run, const ReleaseDesk& desk,
                  std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
