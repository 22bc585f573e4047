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

/// Called with all numbers of the register once it could be read; an error: no number is drawn.
using NumbersCheck = std::function<Expected<void>(const std::vector<certificates::RegisterEntry>&)>;

/// What certificates need.
struct ReleaseDesk {
  certificates::Signer* signer = nullptr;              ///< null: nothing is signed
  const certificates::Releasing* releasing = nullptr;  ///< null: it is a run
  NumbersCheck recheck{};                              ///< empty: the register was read before
  PluginHost* plugins = nullptr;                       ///< makes the processes that evaluate
  /// Of campaigns whose documents show their machine's history; the others do without.
  std::map<std::string, assessment::HistoryBasis> histories{};
  /// Register and key are on another host: campaigns that need them stay to do.
  bool elsewhere = false;
};

/// Does every campaign that is to do, in workers of its own. False if it was interrupted.
bool do_campaigns(const RunOptions& options, const RunEvents& events,
                  const reading::Context& context, const RunState& run, const ReleaseDesk& desk,
                  std::vector<CampaignState>& campaigns);

}  // namespace nonio::batch
