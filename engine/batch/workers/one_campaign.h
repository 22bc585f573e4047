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

/// Data shared by all campaigns of a run, or by the one that is approved.
struct SiteWork {
  const RunOptions& options;
  const reading::Context& context;
  const RunState& run;
  const std::vector<CampaignState>& campaigns;
  const certificates::Numbers& numbers;
  certificates::Signer* signer;  ///< process with the key; null: nothing is signed
  const reading::Twins* twins;   ///< shared files of readings of the campaign that is approved;
                                 ///< null in a run
  /// History by campaign, for campaigns whose documents show it.
  const std::map<std::string, assessment::HistoryBasis>& histories;
  bool elsewhere = false;  ///< whether register and key are on another host; campaigns that need
                           ///< them are left to the merge
};

/// The register of certificates, as known when a worker is started.
struct RegisterState {
  bool read = true;         ///< whether the register was read; false: another process keeps it
                            ///< locked
  std::string unsound{};    ///< why no number can be assigned; empty: numbers can be assigned
  bool last_trial = false;  ///< whether this is the last attempt, which does not wait for the lock
                            ///< any longer
};

/// Evaluates one campaign in the worker, which contains no plugin code: plugins run at the other
/// end of the evaluator's stream. If required, the certificate gets a number and is signed. The
/// files are staged. `first`: the first campaign of this process. Exceptions of plugins are caught
/// where they are called. With Answer::not_stored, `stage` states why. `shows_history`: set if a
/// document of the campaign shows the machine's history.
Answer do_campaign(const SiteWork& site, const RegisterState& state, std::size_t index, bool first,
                   process::SharedStatus& stage, Evaluator& evaluator, bool& shows_history);

}  // namespace nonio::batch
