// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "batch/run.h"
#include "campaign/config/terminal_words.h"
#include "common.h"

/// Functions shared by the commands that do a run or a part of it.
namespace nonio::app {

/// Sets folders, plugins, templates and version according to the command line, catches signals, and
/// prints a warning if the user is root.
void prepare_run(batch::RunOptions& options, const std::string& site, const std::string& out,
                 const Common& common);
/// Returns the exit status of a run, or of a part of it, that did not complete; none if it did.
std::optional<int> exit_of_unfinished(const batch::RunResult& run);
/// Prints the counts of a run, the actions required, and the path of its summary. With `json`,
/// prints one event with the counts and the path.
void print_summary(const batch::RunResult& run, const std::filesystem::path& out,
                   const config::TerminalWords& words, bool json);

Argument jobs_argument(batch::RunOptions& options);
Argument root_argument(batch::RunOptions& options);

}  // namespace nonio::app
