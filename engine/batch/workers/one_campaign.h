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

/// Data of all campaigns of a run, or of the campaign that is approved.
struct SiteWork {
  const RunOptions& options;
  const reading::Context& context;
  const RunState& run;
  const std::vector<CampaignState>& campaigns;
  const certificates::Numbers& numbers;
  certificates::Signer* signer;
  /// Shared files of readings of an approved campaign; null in a run.
  const reading::Twins* twins;
  /// Machine histories by campaign id.
  const std::map<std::string, assessment::HistoryBasis>& histories;
  /// Whether register and key are on another host; campaigns that need them are left to the merge.
  bool elsewhere = false;
};

struct RegisterState {
  bool read = true;         ///< false if another process has locked the register
  std::string unsound{};    ///< reason why no number can be assigned
  bool last_trial = false;  ///< whether a locked register is an error instead of a reason to wait
};

/// Evaluates one campaign in the worker, while plugins run at the other end of the stream of
/// `evaluator`. If required, assigns a certificate number and signs. The files are staged. `first`
/// means the first campaign of this process. After Answer::not_stored, `stage` contains the reason.
/// Sets `shows_history` if a document contains the machine history.
Answer do_campaign(const SiteWork& site, const RegisterState& state, std::size_t index, bool first,
                   process::SharedStatus& stage, Evaluator& evaluator, bool& shows_history);

}  // namespace nonio::batch
