// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::app {

/// What a monitoring system asks of an output folder, as OpenMetrics text (version 1.0.0): time and age
/// of the last complete run, its campaigns by state, the lines of the worklist by kind, drafts. From
/// OUT/summary.json. Errors: there is none, or it cannot be read.
Expected<std::string> metrics_of(const std::filesystem::path& out);

}  // namespace nonio::app
