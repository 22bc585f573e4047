// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "batch/state/run_result.h"
#include "campaign/reading/context.h"
#include "laboratory/assessment/last_run.h"

namespace nonio::batch {

/// What a run reports to people.
struct WorklistPages {
  std::string text;  ///< of summary.txt: one line per action, without what failed or is lost
  std::string json;  ///< the same lines as a list, of summary.json
  std::uint64_t asking = 0;  ///< lines that are new and no mere notes
  bool judged = true;        ///< some campaign states a limit
  std::string actions;  ///< like `json`, in the language of the site: lines that require action
  std::string mail;     ///< the lines that are grave enough for one; empty: none is
};

/// What the run knows and the history does not.
assessment::LastRun last_run_of(const RunResult& run, const std::filesystem::path& out,
                                const Templates& templates);

/// Assesses the histories of the machines, and writes the pages that are not as they were:
/// OUT/index.html, machines/, due.html, due.ics, instruments.html, compare.html. In a process of
/// its own, which may take `disk_seconds` without a sign of life. Of sites with more campaigns than
/// `most_curves` no error curves are drawn, and machines of which nothing is new are not looked at
/// again.
Expected<WorklistPages> make_worklist(const RunOptions& options, const reading::Context& context,
                                      const assessment::LastRun& last_run,
                                      std::uint64_t most_curves = 5000);

}  // namespace nonio::batch
