// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Mean deviation at each target, of all campaigns that a machine's series name, by day: out of
/// their results.json, for whoever draws them. Campaigns whose results cannot be read are left out.
std::vector<reports::ErrorCurve> curves_of(const std::filesystem::path& out,
                                           const reports::MachineHistory& machine);

}  // namespace nonio::assessment
