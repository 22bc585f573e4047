// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/math/rotary_plan.h"

namespace nonio::planning {

struct RotaryRow {
  math::RotaryPlan plan;
  math::RotaryPlanU u;
};

/// Simulates the user's plan, then 3, 4, 5 and 10 balls at its radius, at 500 mm and at 50 mm. Only
/// an invalid plan of the user is an error.
Expected<std::vector<RotaryRow>> rotary_rows(const math::RotaryPlan& own, std::size_t trials,
                                             std::uint64_t seed);

/// Returns the smallest number of balls at the radius of the plan. U: k = 2, m and rad; 0 if not
/// required.
Expected<std::size_t> fewest_balls(const math::RotaryPlan& own, double U_centre,
                                   double U_direction);

}  // namespace nonio::planning
