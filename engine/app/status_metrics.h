// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::app {

/// Returns OpenMetrics text (version 1.0.0) about the last complete run of an output folder: its
/// age, the numbers of campaigns, worklist lines and drafts. An error if OUT/summary.json cannot be
/// read.
/// With `site`, drafts are those that wait now.
Expected<std::string> metrics_of(const std::filesystem::path& out, const std::string& site);

}  // namespace nonio::app
