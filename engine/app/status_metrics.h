// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::app {

/// Returns the state of an output folder as OpenMetrics text (version 1.0.0) for monitoring
/// systems: time and age of the last complete run, its campaigns by state, the lines of the
/// worklist by kind, drafts. The source is OUT/summary.json; an error if it does not exist or
/// cannot be read.
Expected<std::string> metrics_of(const std::filesystem::path& out);

}  // namespace nonio::app
