// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Removes what a run that was cut short left in the output folder itself.
void tidy_root(const std::filesystem::path& out);

/// Nothing half-done is left in a folder that other programs read. Where a run was cut short (`resumed`),
/// it may lie in folders of campaigns that are not in the site any more. An error if it was
/// interrupted, or a folder cannot be read.
Expected<void> tidy_all(const RunResult& run, const std::filesystem::path& out, bool resumed);

}  // namespace nonio::batch
