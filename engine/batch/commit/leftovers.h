// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Removes temporary files of an interrupted run from the output folder and its folder .nonio.
void tidy_root(const std::filesystem::path& out);

/// Removes temporary files from the output folder and the results folders of campaigns that this
/// run evaluated; if `resumed`, from all results folders. An error if a stop was requested, a
/// folder cannot be read or a file cannot be removed.
Expected<void> tidy_all(const RunResult& run, const std::filesystem::path& out, bool resumed);

}  // namespace nonio::batch
