// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Removes temporary files that an interrupted run left directly in the output folder or in its
/// folder .nonio.
void tidy_root(const std::filesystem::path& out);

/// Removes unfinished files from the output folder and from the results folders of campaigns that
/// this run evaluated, because other programs read them. After an interrupted run (`resumed`), all
/// results folders are included, also those of campaigns that are no longer in the site. An error
/// if a stop is requested, a folder cannot be read, or a file cannot be removed.
Expected<void> tidy_all(const RunResult& run, const std::filesystem::path& out, bool resumed);

}  // namespace nonio::batch
