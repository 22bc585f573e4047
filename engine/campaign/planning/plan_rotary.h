// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/math/rotary_plan.h"

/// What `nonio plan rotary` prints.
namespace nonio::planning {

struct RotaryRow {
  math::RotaryPlan plan;
  math::RotaryPlanU u;
};

/// Simulated: the plan of the user first, then 3, 4, 5 and 10 balls at its radius and at 500 and
/// 50 mm. An error is that of the user's own plan; others that are not sound are left out.
Expected<std::vector<RotaryRow>> rotary_rows(const math::RotaryPlan& own, std::size_t trials,
                                             std::uint64_t seed);

/// The fewest balls for a wanted U (k = 2; m, rad; 0: none) at the plan's radius.
Expected<std::size_t> fewest_balls(const math::RotaryPlan& own, double U_centre,
                                   double U_direction);

}  // namespace nonio::planning
