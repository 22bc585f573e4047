// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "batch/state/run_result.h"
#include "campaign/reading/context.h"
#include "laboratory/assessment/last_run.h"

namespace nonio::batch {

/// The worklist of a run as texts for the summary, the pages and the mail, with the number of lines
/// that require action.
struct WorklistPages {
  std::string text;  ///< worklist for summary.txt: one line per action; failed and lost campaigns
                     ///< are listed elsewhere
  std::string json;  ///< lines of the worklist for summary.json, as a JSON list
  std::uint64_t asking = 0;  ///< number of new lines that require action
  bool judged = true;        ///< whether at least one campaign states a tolerance limit
  std::string actions;       ///< lines that require action as JSON, in the language of the site
  std::string mail;          ///< lines that are severe enough for a mail; empty: no mail
};

/// Collects the facts of the run that the history does not contain: its number, date and counts,
/// failed and vanished campaigns, issued certificates, drafts, and the error of the history.
assessment::LastRun last_run_of(const RunResult& run, const std::filesystem::path& out,
                                const Templates& templates);

/// Assesses the histories of the machines and writes the pages that have changed: OUT/index.html,
/// machines/, due.html, due.ics, instruments.html, compare.html. Runs in a child process that may
/// take `disk_seconds` without a sign of life. For sites with more than `most_curves` campaigns, no
/// error curves are drawn and machines without new data are not assessed again.
Expected<WorklistPages> make_worklist(const RunOptions& options, const reading::Context& context,
                                      const assessment::LastRun& last_run,
                                      std::uint64_t most_curves = 5000);

}  // namespace nonio::batch
