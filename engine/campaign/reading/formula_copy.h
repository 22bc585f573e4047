// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

namespace nonio::reading {

/// Returns the effect of the catalog with the same span as `own` on these readings, without zeros
/// of lines; "zero" if nothing remains, "" if `own` is new. Shapes of the catalog are searched;
/// those of `own` have the middle of their grids.
Expected<std::string> copy_of(const Observations& observations, const Axis& axis, const Effect& own,
                              const std::vector<Effect>& catalogue);

}  // namespace nonio::reading
