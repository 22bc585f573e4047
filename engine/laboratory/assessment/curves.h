// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Reads the mean deviations at the targets from results.json of all campaigns in a machine's
/// series, ordered by day, to draw error curves. Campaigns whose results cannot be read are left
/// out.
std::vector<reports::ErrorCurve> curves_of(const std::filesystem::path& out,
                                           const reports::MachineHistory& machine);

}  // namespace nonio::assessment
