// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Removes temporary files that an interrupted run left directly in the output folder.
void tidy_root(const std::filesystem::path& out);

/// Removes unfinished files from the results folders, because other programs read them. After an
/// interrupted run (`resumed`), folders of campaigns that are no longer in the site are included.
/// An error if it was interrupted or a folder cannot be read.
Expected<void> tidy_all(const RunResult& run, const std::filesystem::path& out, bool resumed);

}  // namespace nonio::batch
