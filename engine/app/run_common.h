// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "batch/run.h"
#include "campaign/config/terminal_words.h"
#include "common.h"

namespace nonio::app {

/// Sets the options of the command line and installs the signal handlers. Warns if the user is
/// root.
void prepare_run(batch::RunOptions& options, const std::string& site, const std::string& out,
                 const Common& common);
/// Returns the exit status of a run that did not complete, or std::nullopt.
std::optional<int> exit_of_unfinished(const batch::RunResult& run);
/// Prints the counts of a run, the actions required and the path of its summary; with `json` one
/// event with the counts and the path.
void print_summary(const batch::RunResult& run, const std::filesystem::path& out,
                   const config::TerminalWords& words, bool json);

Argument jobs_argument(batch::RunOptions& options);
Argument root_argument(batch::RunOptions& options);

}  // namespace nonio::app
