// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Returns the error curves of all campaigns in the series of a machine, ordered by date: mean
/// deviations at the targets from results.json. Campaigns without readable results are omitted.
std::vector<reports::ErrorCurve> curves_of(const std::filesystem::path& out,
                                           const reports::MachineHistory& machine);

}  // namespace nonio::assessment
