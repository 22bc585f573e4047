// SPDX-License-Identifier: Apache-2.0
// Intervals: published examples (NCSLI 2019 tutorial, RP-1 table D-1, NASA-HDBK-8739.19-5 through
// suncal), and what a history cannot tell.
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

std::vector<Tried> table_d1() {  // weeks
  const int weeks[] = {4, 7, 10, 13, 21, 28, 40, 48}, n[] = {4, 6, 14, 13, 22, 49, 18, 6},
            passed[] = {4, 5, 9, 8, 12, 20, 9, 2};
  std::vector<Tried> out;
  for (int i = 0; i < 8; ++i) out.push_back({double(weeks[i]), n[i], passed[i]});
  return out;
}

TEST(Intervals, ReliabilityModelsOfTableD1) {
  using Model = Reliability::Model;
  const auto e = likeliest(Model::exponential, table_d1()),
             w = likeliest(Model::weibull, table_d1()),
             r = likeliest(Model::random_walk, table_d1());
  ASSERT_TRUE(e && w && r);
  EXPECT_NEAR(e->a, 0.028116, 6e-7);
  EXPECT_NEAR(-e->log_likelihood, 87.6294, 6e-5);
  EXPECT_NEAR(w->a, 0.024320, 6e-7);
  // 0.701294 by scipy too, with the gradient to 1e-14; 0.701394 is printed elsewhere, whose time to
  // 75 % would be 6.960.
  EXPECT_NEAR(w->b, 0.701294, 6e-7);
  EXPECT_NEAR(-w->log_likelihood, 86.9853, 6e-5);
  EXPECT_NEAR(r->a, 0.0, 1e-9);
  EXPECT_NEAR(r->b, 0.0954142, 6e-8);
  EXPECT_NEAR(-r->log_likelihood, 86.4020, 6e-5);
  EXPECT_NEAR(e->at(10.232), 0.75, 2e-5);
  EXPECT_NEAR(w->at(6.958), 0.75, 2e-5);
  EXPECT_NEAR(r->at(7.920), 0.75, 2e-5);
  const Proposal p = reliability(table_d1(), 0.75);
  ASSERT_TRUE(p.months);
  EXPECT_NEAR(*p.months, 7.920, 6e-4);  // of the random walk, the likeliest
}

TEST(Intervals, ReliabilityThatNobodyTriedIsRefused) {
  EXPECT_EQ(reliability(table_d1(), 0.2).why, "beyond-tried");
  EXPECT_EQ(reliability({{6, 10, 8}, {12, 5, 4}}, 0.9).why, "few-machines");
  EXPECT_EQ(reliability({{6, 20, 18}, {12, 25, 20}}, 0.9).why, "few-times");
  EXPECT_EQ(reliability({{6, 20, 20}, {12, 25, 25}, {18, 9, 9}}, 0.9).why, "all-passed");
  EXPECT_EQ(reliability(table_d1(), 1.0).why, "no-target");
  EXPECT_FALSE(reliability(table_d1(), 1.0).months);
}

const std::vector<double> since{70, 86, 104, 135, 167, 173},
    drifted{.1, .11, .251, .299, .403, .615};

TEST(Intervals, DriftSinceTheAdjustment) {
  const auto d = drift_since_adjustment(since, drifted, 2);
  ASSERT_TRUE(d);
  EXPECT_NEAR(d->b[0], 1.57407e-4, 6e-10);
  EXPECT_NEAR(d->b[1], 1.67379e-5, 6e-11);
  EXPECT_NEAR(d->C[0], 1.010e-6, 6e-10);
  EXPECT_NEAR(d->C[1], -6.607e-9, 6e-13);
  EXPECT_NEAR(d->C[3], 4.549e-11, 6e-15);
  EXPECT_NEAR(d->s, 0.0708, 6e-5);
  EXPECT_NEAR(*until_uncertainty(*d, 0.28, 0.5, 1000), 327.15, 6e-3);
  EXPECT_NEAR(*until_limit(*d, 10.03, 0.28, {9.0, 11.0}, 0.90, 1000), 140.09, 6e-3);
  EXPECT_NEAR(*until_limit(*d, 10.03, 0.28, {{}, 11.0}, 0.90, 1000), 171.75, 6e-3);
  // The handbook prints 153.04 for a value that is out at once.
  EXPECT_EQ(*until_limit(*d, 9.03, 0.28, {9.0, 11.0}, 0.90, 1000), 0.0);
  EXPECT_FALSE(until_limit(*d, 10.03, 0.28, {}, 0.90, 1000));
  EXPECT_FALSE(drift_since_adjustment({1, 2, 3}, {1, 2, 3}, 2));
}

TEST(Intervals, DriftIsNotFollowedFarBeyondWhatWasSeen) {
  std::vector<double> t;
  for (const double day : since) t.push_back(day * days);
  const Proposal meets = drift_interval(t, drifted, 2, 10.03, 0.28, {9.0, 11.0}, 0.90);
  EXPECT_EQ(meets.why, "drift-meets-limit");
  EXPECT_NEAR(*meets.months / days, 140.09, 6e-3);
  const Proposal far = drift_interval(t, drifted, 2, 10.03, 0.28, {0.0, 20.0}, 0.90);
  EXPECT_EQ(far.why, "as-far-as-seen");
  EXPECT_NEAR(*far.months, 1.5 * 173 * days, 1e-9);
  EXPECT_EQ(drift_interval(t, drifted, 2, 9.03, 0.28, {9.0, 11.0}).why, "out-already");
  EXPECT_EQ(drift_interval(t, drifted, 2, 9.03, 0.28, {}).why, "no-limit");
  EXPECT_EQ(drift_interval({1.0}, {0.1}, 2, 9.03, 0.28, {9.0, 11.0}).why, "few-readings");
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
  EXPECT_TRUE(control_chart(crashed, stepped, 50).months) << "nobody was told of it";
}

}  // namespace
}  // namespace nonio::statistics::intervals_test
