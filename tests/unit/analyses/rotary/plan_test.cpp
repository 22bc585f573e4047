// SPDX-License-Identifier: Apache-2.0
//
// U of a rotary axis before the measurement: against the figures of 20,000 simulated measurements by
// another program (sigma 10 um) and against their closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "nonio/math/rotary_plan.h"

namespace nonio::fixtures::rotary_plan_test {
namespace {

using math::cheapest;
using math::expected_of;
using math::RotaryPlan;
using math::simulated;

constexpr std::uint64_t seed = 20261125;
constexpr double um = 1e-6, urad = 1e-6;

struct Golden {
  double R;  // mm
  std::size_t N;
  double across, along, mean, rms, direction_rms, direction_mean;  // um, urad
};
constexpr Golden golden[] = {{500, 3, 8.16, 5.77, 11.87, 12.91, 23.09, 20.4},
                             {500, 4, 7.07, 5.00, 10.26, 11.18, 20.00, 17.7},
                             {500, 5, 6.32, 4.47, 9.16, 10.00, 17.89, 15.8},
                             {500, 10, 4.47, 3.16, 6.48, 7.07, 12.65, 11.2},
                             {50, 3, 8.16, 5.77, 11.87, 12.91, 230.9, 204.4},
                             {50, 4, 7.07, 5.00, 10.26, 11.18, 200.0, 176.6},
                             {50, 5, 6.32, 4.47, 9.16, 10.00, 178.9, 158.2},
                             {50, 10, 4.47, 3.16, 6.48, 7.07, 126.5, 112.3}};

TEST(RotaryPlan, FiguresAreThoseOfTheTable) {
  std::cout << "seed " << seed << "\n";
  for (const Golden& g : golden) {
    const RotaryPlan plan{g.N, g.R * 1e-3, 2.0 * std::numbers::pi, 10 * um};
    const auto linear = expected_of(plan);
    ASSERT_TRUE(linear) << g.N;
    EXPECT_NEAR(linear->across, g.across * um, 0.005 * um) << g.N;
    EXPECT_NEAR(linear->along, g.along * um, 0.005 * um) << g.N;
    EXPECT_NEAR(linear->centre_rms, g.rms * um, 0.005 * um) << g.N;
    EXPECT_NEAR(linear->direction_rms, g.direction_rms * urad, 5e-4 * g.direction_rms * urad)
        << g.N;
    const auto u = simulated(plan, 20000, seed + g.N);
    ASSERT_TRUE(u) << g.N;
    EXPECT_NEAR(u->centre_rms, g.rms * um, 0.02 * g.rms * um) << g.N;
    EXPECT_NEAR(u->centre_mean, g.mean * um, 0.02 * g.mean * um) << g.N;
    EXPECT_NEAR(u->direction_rms, g.direction_rms * urad, 0.02 * g.direction_rms * urad) << g.N;
    EXPECT_NEAR(u->direction_mean, g.direction_mean * urad, 0.02 * g.direction_mean * urad) << g.N;
  }
}

/// Arcs: R = 261 mm, 11 balls, sigma 10 um; towards the arc, along the axis, the worse tilt.
TEST(RotaryPlan, ShortArcsCostMost) {
  struct Arc {
    double deg, towards, along, tilt;
  };
  for (const Arc& a : {Arc{270, 5.0, 3.2, 19}, Arc{180, 8.5, 5.7, 33}, Arc{150, 11.5, 8.5, 44},
                       Arc{90, 29, 26, 112}, Arc{60, 64, 60, 244}}) {
    const auto u = expected_of({11, 0.261, a.deg * std::numbers::pi / 180.0, 10 * um});
    ASSERT_TRUE(u) << a.deg;
    EXPECT_NEAR(u->across, a.towards * um, 0.02 * a.towards * um) << a.deg;
    EXPECT_NEAR(u->along, a.along * um, 0.02 * a.along * um) << a.deg;
    EXPECT_NEAR(u->tilt, a.tilt * urad, 0.02 * a.tilt * urad) << a.deg;
  }
}

TEST(RotaryPlan, TheCheapestPlanReachesWhatIsWantedAndOneBallLessDoesNot) {
  const RotaryPlan plan{4, 0.25, 2.0 * std::numbers::pi, 1.5 * um};
  const auto centre = cheapest(plan, 2 * um, 0.0);
  ASSERT_TRUE(centre);
  EXPECT_EQ(*centre, 5U) << "2 * 1.5 sqrt(2/5) = 1.90, sqrt(2/4) gives 2.12";
  const auto direction = cheapest(plan, 0.0, 4 * urad);
  ASSERT_TRUE(direction);
  EXPECT_EQ(*direction, 18U) << "2 * 6 urad sqrt(2/18) = 4";
  EXPECT_FALSE(cheapest(plan, 0.01 * um, 0.0));
  EXPECT_FALSE(expected_of({2, 0.25, 6.28, 1 * um}));
  EXPECT_FALSE(simulated({4, 1e-5, 6.28, 1 * um}, 100, seed));
}

}  // namespace
}  // namespace nonio::fixtures::rotary_plan_test
