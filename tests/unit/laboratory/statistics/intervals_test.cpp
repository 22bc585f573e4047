// SPDX-License-Identifier: Apache-2.0
// Intervals: published examples (NCSLI 2019 tutorial), and what a history cannot
// determine.
#include "laboratory/statistics/intervals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "made.h"

namespace nonio::statistics::intervals_test {
namespace {

constexpr double days = 12.0 / 365.25;  // months

double number(const Proposal& p, const std::string& name) {
  for (const auto& [n, value] : p.numbers)
    if (n == name) return value;
  return NAN;
}

struct A3 {
  int passed, machines;
  double target, interval, Q, expected;
};

TEST(Intervals, FleetsByA3) {
  for (const A3& c : {A3{15, 20, .95, 365, .9949, 230.85}, A3{14, 20, .95, 365, .9993, 205.33},
                      A3{16, 20, .95, 730, .9682, 522.51}, A3{42, 50, .9, 365, .7557, 328.81}}) {
    const Proposal p = fleet(c.interval * days, c.passed, c.machines, c.target);
    ASSERT_TRUE(p.months);
    EXPECT_NEAR(*p.months / days, c.expected, 5.1e-3);
    EXPECT_NEAR(number(p, "Q"), c.Q, 5.1e-5);
    EXPECT_EQ(p.why, "fleet-shorter");
  }
}

TEST(Intervals, FleetsThatHoldGetLonger) {
  // 30 of 30 at 0.9: Q = 1 - 0.9^30, 10^(0.1/0.9^30) = 228: not above twice.
  EXPECT_NEAR(*fleet(12, 30, 30, 0.9).months, 24.0, 1e-12);
  EXPECT_NEAR(*fleet(12, 8, 8, 0.9).months, 12.0 * std::pow(10.0, 0.1 / std::pow(0.9, 8)), 1e-9);
  // 99 of 100 at 0.9: longer too, which a Q that is never positive does not give.
  EXPECT_EQ(fleet(12, 99, 100, 0.9).why, "fleet-longer");
  EXPECT_GT(*fleet(12, 99, 100, 0.9).months, 14.0);
  EXPECT_NEAR(*fleet(12, 2, 40, 0.95).months, 6.0, 1e-12);  // not below half
  // Five of five shows nothing at 0.95.
  EXPECT_EQ(fleet(12, 5, 5, 0.95).why, "fleet-as-it-is");
  EXPECT_EQ(*fleet(12, 5, 5, 0.95).months, 12.0);
}

TEST(Intervals, TheStaircaseIsBalanced) {
  for (const double R : {0.75, 0.95}) {
    const double up = *staircase(12, Found::conforms, R).months / 12,
                 down = *staircase(12, Found::fails, R).months / 12;
    EXPECT_NEAR(R * std::log(up) + (1 - R) * std::log(down), 0.0, 1e-12);
    EXPECT_GT(up, 1.0);
    EXPECT_EQ(down, 0.5);
  }
  EXPECT_EQ(*staircase(12, Found::undecided).months, 12.0);
  EXPECT_EQ(staircase(12, Found::undecided).why, "undecided");
  EXPECT_FALSE(staircase(0, Found::fails).months);
  EXPECT_EQ(staircase(0, Found::fails).why, "no-interval");
  EXPECT_EQ(staircase(12, Found::fails, 1.0).why, "no-target");
}

TEST(Intervals, TheControlChartEndsWhereTheBoundMeetsTheLimit) {
  const Series s = reference_series();
  const Trend t = *trend_of(s);
  const Proposal p = control_chart(s, t, 6.2);
  EXPECT_EQ(p.why, "meets-limit");
  const double last = 3.5, then = last + *p.months / 12.0;
  const Forecast f = forecast(s, t, then, 6.2);
  EXPECT_NEAR(std::fabs(f.value) + 1.6448536269514722 * f.u, 6.2, 1e-9);
  // Not farther than half of the 3.5 years that are known.
  const Proposal far = control_chart(s, t, 50);
  EXPECT_EQ(far.why, "as-far-as-seen");
  EXPECT_NEAR(*far.months, 21.0, 1e-12);
  EXPECT_NEAR(*control_chart(s, t, 9.0).months, 21.0, 1e-12);
  EXPECT_EQ(control_chart(s, t, 5.0).why, "out-already");
  EXPECT_FALSE(control_chart(s, t, 5.0).months);
  Series two = s;
  two.points.resize(2);
  EXPECT_EQ(control_chart(two, *trend_of(two), 50).why, "few-campaigns");
  Series crashed = s;
  crashed.points.back().value = 20.0;
  const Trend stepped = *trend_of(crashed);
  const std::size_t last_point = s.points.size() - 1;
  ASSERT_EQ(stepped.changes.back().after + 1, last_point);
  EXPECT_EQ(control_chart(crashed, stepped, 50, last_point - 1).why, "change-not-explained");
  EXPECT_TRUE(control_chart(crashed, stepped, 50, last_point - 2).months);
  EXPECT_TRUE(control_chart(crashed, stepped, 50).months) << "no message was sent";
}

}  // namespace
}  // namespace nonio::statistics::intervals_test
