// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/math/rotary_plan.h"

/// Computes what `nonio plan rotary` prints.
namespace nonio::planning {

struct RotaryRow {
  math::RotaryPlan plan;
  math::RotaryPlanU u;
};

/// Simulates plans: first the user's, then 3, 4, 5 and 10 balls at its radius, at 500 mm and at 50
/// mm. An invalid plan of the user is an error; other invalid plans are left out.
Expected<std::vector<RotaryRow>> rotary_rows(const math::RotaryPlan& own, std::size_t trials,
                                             std::uint64_t seed);

/// Returns the smallest number of balls with which these U are reached (k = 2; m, rad; 0: not
/// required) at the radius of the plan.
Expected<std::size_t> fewest_balls(const math::RotaryPlan& own, double U_centre,
                                   double U_direction);

}  // namespace nonio::planning
