// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "batch/close/worklist_update.h"
#include "batch/state/run_result.h"
#include "campaign/config/terminal_words.h"

namespace nonio::batch {

/// Returns the first error with file and line, and the number of further errors in the language of
/// `words`, for example "(and 3 more)". Without an error, returns the English reason of the
/// evaluation.
std::string first_error(const CampaignState& c, const config::TerminalWords& words);

/// Translates the reason why a campaign was evaluated or not.
std::string reason_in(const std::string& text, const config::TerminalWords& words);

/// Writes summary.txt, in the language of `words`, and summary.json (nonio-summary/1), in English,
/// into `out`. Records are read one at a time and long lists are kept in files, so that the memory
/// does not grow with the number of campaigns.
Expected<void> write_summary(const RunResult& run, const std::filesystem::path& out,
                             const std::string& version, const config::TerminalWords& words,
                             const WorklistPages& worklist);

}  // namespace nonio::batch
