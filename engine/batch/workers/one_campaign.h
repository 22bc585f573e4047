// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "batch/workers/computing.h"
#include "batch/workers/worker.h"
#include "certificates/numbering.h"
#include "certificates/signer.h"
#include "laboratory/assessment/history_so_far.h"

namespace nonio::batch {

/// What all campaigns of a run, or the one that is released, share.
struct SiteWork {
  const RunOptions& options;
  const reading::Context& context;
  const RunState& run;
  const std::vector<CampaignState>& campaigns;
  const certificates::Numbers& numbers;
  certificates::Signer* signer;  ///< null: nothing is signed
  const reading::Twins* twins;   ///< of the one campaign that is released; null: it is a run
  /// Of campaigns whose documents show their machine's history.
  const std::map<std::string, assessment::HistoryBasis>& histories;
  bool elsewhere = false;  ///< register and key are: what needs them waits
};

/// The register of certificates, as known when a worker is started.
struct RegisterState {
  bool read = true;         ///< false: another process keeps it to itself
  std::string unsound{};    ///< why no number is drawn; empty: it is sound
  bool last_trial = false;  ///< no process waits for it any longer
};

/// In the worker's process, which has no plugin code: that runs at the other end of the evaluator's
/// stream. Evaluates one campaign, numbers and signs it where that is required, and stages its
/// files. `first`: no campaign was done in this process before. What plugins throw is caught where
/// they are called. With Answer::not_stored the stage states why. `shows_history`: whether a
/// document of the campaign shows the machine's.
Answer do_campaign(const SiteWork& site, const RegisterState& state, std::size_t index, bool first,
                   process::SharedStatus& stage, Evaluator& evaluator, bool& shows_history);

}  // namespace nonio::batch
