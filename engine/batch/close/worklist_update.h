// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "batch/state/run_result.h"
#include "campaign/reading/context.h"
#include "laboratory/assessment/last_run.h"

namespace nonio::batch {

struct WorklistPages {
  /// Text for summary.txt, without failed and lost campaigns, which are separate lists.
  std::string text;
  std::string json;          ///< JSON list for summary.json
  std::uint64_t asking = 0;  ///< number of lines that require action
  bool judged = true;        ///< whether any result has a tolerance limit
  std::string actions;       ///< lines that require action as JSON, in the language of the site
  std::string mail;          ///< lines that are severe enough for a mail; empty if no mail is sent
};

/// Collects what the history does not contain: number, date and counts of the run, failed and
/// missing campaigns, certificates, drafts and the error of the history.
assessment::LastRun last_run_of(const RunResult& run, const std::filesystem::path& out,
                                const Templates& templates);

/// Assesses the histories of the machines and writes the pages that have changed, in a child
/// process that may take `disk_seconds` without a sign of life. With more than `most_curves`
/// campaigns, error curves are omitted and only machines with new data are assessed.
Expected<WorklistPages> make_worklist(const RunOptions& options, const reading::Context& context,
                                      const assessment::LastRun& last_run,
                                      std::uint64_t most_curves = 5000);

}  // namespace nonio::batch
