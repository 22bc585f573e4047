// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

namespace nonio::reading {

/// Returns the name of the effect of the catalogue that equals `own` on these readings: its columns
/// span the same space after subtraction of a zero for each line. "zero" if nothing remains after
/// the subtraction, "" if `own` is new. Shapes of the catalogue are searched; those of `own` are in
/// the middle of their grids.
Expected<std::string> copy_of(const Observations& observations, const Axis& axis, const Effect& own,
                              const std::vector<Effect>& catalogue);

}  // namespace nonio::reading
