// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "batch/run.h"
#include "campaign/config/terminal_words.h"
#include "common.h"

/// Shared by the commands that do a run or a part of it.
namespace nonio::app {

/// Folders, plugins, templates and version as the command line has them; signals are caught, and
/// root is warned.
void prepare_run(batch::RunOptions& options, const std::string& site, const std::string& out,
                 const Common& common);
/// The exit status of a run, or of a part of it, that did not complete; none if it did.
std::optional<int> exit_of_unfinished(const batch::RunResult& run);
/// The counts of a run, what requires action, and the path of its summary.
void print_summary(const batch::RunResult& run, const std::filesystem::path& out,
                   const config::TerminalWords& words, bool json);

Argument jobs_argument(batch::RunOptions& options);
Argument root_argument(batch::RunOptions& options);

}  // namespace nonio::app
