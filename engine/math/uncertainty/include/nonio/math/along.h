// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/math/uncertainty.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"

namespace nonio::math {

/// Returns the axes whose ends differ, sorted by name.
std::vector<std::string> moving_axes(const Measurement&);
/// Unit vector from `from` to `to`, in the order of `moving_axes`.
std::vector<double> direction_along(const Measurement&);
/// The positive direction is from corner `from` to corner `to`.
Observations along_diagonal(const Observations&, const Measurement&);

/// Returns the budget of positioning along the diagonal, or the missing keys. The machine expands
/// along it by the sum of c^2 alpha over the axes, with c the components of the direction.
BudgetOrGap budget_along(const Campaign&, const Environment&, const Measurement&, const AxisTest&);

}  // namespace nonio::math
