// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "batch/close/worklist_update.h"
#include "batch/state/run_result.h"
#include "campaign/config/terminal_words.h"

namespace nonio::batch {

/// With its file and line, and "(and 3 more)" in the language of `words`; why it was done where there
/// is no error.
std::string first_error(const CampaignState& c, const config::TerminalWords& words);

/// Why a campaign is done or not, in the language of `words`.
std::string reason_in(const std::string& text, const config::TerminalWords& words);

/// summary.txt and summary.json (schema nonio-summary/1) of a complete run, written into `out`.
/// summary.txt speaks the language of `words`, summary.json English. The findings come from the
/// campaigns' records there, one at a time; the lists grow in files.
Expected<void> write_summary(const RunResult& run, const std::filesystem::path& out,
                             const std::string& version, const config::TerminalWords& words,
                             const WorklistPages& worklist);

}  // namespace nonio::batch
