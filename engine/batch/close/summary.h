// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "batch/close/worklist_update.h"
#include "batch/state/run_result.h"
#include "campaign/config/terminal_words.h"

namespace nonio::batch {

/// Returns the campaign's first error with its file and line; if there are more, followed by their
/// number in the language of `words`, for example "(and 3 more)". Without an error, returns the
/// reason for which the campaign was evaluated, in English.
std::string first_error(const CampaignState& c, const config::TerminalWords& words);

/// Translates the reason for which a campaign was evaluated or not into the language of `words`.
std::string reason_in(const std::string& text, const config::TerminalWords& words);

/// Writes summary.txt and summary.json (schema nonio-summary/1) of a complete run into `out`.
/// summary.txt is in the language of `words`, summary.json in English. Findings are read from the
/// records of the campaigns one at a time, and long lists are kept in files, so that memory does
/// not grow with the site.
Expected<void> write_summary(const RunResult& run, const std::filesystem::path& out,
                             const std::string& version, const config::TerminalWords& words,
                             const WorklistPages& worklist);

}  // namespace nonio::batch
