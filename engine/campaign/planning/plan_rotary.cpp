// SPDX-License-Identifier: Apache-2.0
#include "campaign/planning/plan_rotary.h"

#include <algorithm>
#include <cmath>

namespace nonio::planning {

namespace {

std::vector<math::RotaryPlan> rotary_plans(const math::RotaryPlan& own) {
  std::vector<math::RotaryPlan> out{own};
  for (const double radius : {own.radius, 0.5, 0.05})
    for (const std::size_t balls : {3U, 4U, 5U, 10U}) {
      math::RotaryPlan p = own;
      p.radius = radius;
      p.balls = balls;
      const bool there = std::any_of(out.begin(), out.end(), [&](const math::RotaryPlan& o) {
        return o.balls == balls && std::fabs(o.radius - radius) < 1e-9;
      });
      if (!there) out.push_back(p);
    }
  return out;
}

}  // namespace

Expected<std::vector<RotaryRow>> rotary_rows(const math::RotaryPlan& own, std::size_t trials,
                                             std::uint64_t seed) {
  std::vector<RotaryRow> rows;
  for (const math::RotaryPlan& plan : rotary_plans(own)) {
    const auto u = math::simulated(plan, trials, seed);
    if (u)
      rows.push_back({plan, *u});
    else if (rows.empty())
      return fail(u.error());
  }
  return rows;
}

Expected<std::size_t> fewest_balls(const math::RotaryPlan& own, double U_centre,
                                   double U_direction) {
  return math::cheapest(own, U_centre, U_direction);
}

}  // namespace nonio::planning
