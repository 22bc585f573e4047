// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/math/uncertainty.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"

/// Functions that treat a diagonal between the corners `from` and `to` of a measurement as one
/// line.
namespace nonio::math {

/// Returns the axes whose ends differ, sorted by name; for a face of a volume the third axis does
/// not move.
std::vector<std::string> moving_axes(const Measurement&);
/// Returns the components of the unit vector from `from` to `to`, in the order of `moving_axes`.
std::vector<double> direction_along(const Measurement&);
/// Converts the readings to those of one axis along the diagonal. Its positive direction is from
/// corner `from` to corner `to`.
Observations along_diagonal(const Observations&, const Measurement&);

/// Computes the uncertainty budget of positioning along the diagonal, or returns the missing keys.
/// The machine expands along it by the sum of c^2 alpha over the axes, c: components of the
/// direction.
BudgetOrGap budget_along(const Campaign&, const Environment&, const Measurement&, const AxisTest&);

}  // namespace nonio::math
