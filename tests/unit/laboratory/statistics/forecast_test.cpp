// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/forecast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "made.h"

namespace nonio::statistics::forecast_test {
namespace {

TEST(Forecast, AtTheNextDate) {
  const Series s = reference_series();
  const auto t = trend_of(s);
  ASSERT_TRUE(t && t->drifts);
  const Forecast f = forecast(s, *t, 4.5, 6.5, 0.25);
  EXPECT_NEAR(f.value, -5.9839, 6e-5);
  EXPECT_NEAR(f.u, 0.1973, 6e-5);
  EXPECT_NEAR(f.p_out, 0.00445, 6e-6);
  EXPECT_NEAR(f.p_read_out, 0.05254, 6e-6);
  EXPECT_EQ(f.answer, Answer::keep);
  // The bound, not the line (which comes to 6.5 at 5.718 years).
  ASSERT_TRUE(f.leaves);
  EXPECT_LT(*f.leaves, 5.718);
  EXPECT_GT(*f.leaves, 4.5);
  EXPECT_NEAR((-6.5 - t->coefficients[0]) / t->coefficients[1], 5.718, 6e-4);
}

TEST(Forecast, BeyondHalfOfTheSpanNothingIsSaid) {
  const Series s = reference_series();
  EXPECT_EQ(forecast(s, *trend_of(s), 5.3, 6.5).answer, Answer::cannot_say);
  Series two;
  two.points = {{0.0, 1.0, 0.1}, {1.0, 1.0, 0.1}};
  EXPECT_EQ(forecast(two, *trend_of(two), 1.2, 6.5).answer, Answer::cannot_say);
}

TEST(Forecast, WhatIsOutAlreadyAsksToAct) {
  Series s = reference_series();
  EXPECT_EQ(forecast(s, *trend_of(s), 4.0, 5.0).answer, Answer::act);
}

TEST(Forecast, FollowsTheOriginOfTimesAndValues) {
  Series s = reference_series();
  const Forecast before = forecast(s, *trend_of(s), 4.5, 6.5);
  for (Point& p : s.points) p.time += 17.0;
  const Forecast moved = forecast(s, *trend_of(s), 21.5, 6.5);
  EXPECT_NEAR(moved.value, before.value, 1e-9);
  EXPECT_NEAR(moved.u, before.u, 1e-9);
  EXPECT_NEAR(*moved.leaves, *before.leaves + 17.0, 1e-9);
  for (Point& p : s.points) p.value += 3.0;
  EXPECT_NEAR(forecast(s, *trend_of(s), 21.5, {}).value, before.value + 3.0, 1e-9);
}

TEST(Forecast, TheLastCampaignOutAsksToActWhateverTheModelSays) {
  Series s;
  for (int i = 0; i < 8; ++i) s.points.push_back({0.5 * i, i == 7 ? 1.1 : 0.0, 0.5});
  const Forecast f = forecast(s, *trend_of(s), 4.0, 1.0);
  EXPECT_LT(f.p_out, 0.05);
  EXPECT_EQ(f.answer, Answer::act);
}

TEST(Forecast, OfAWalkGrowsWithTime) {
  Series s;
  const double steps[] = {0, 4, 7, 3, 6, 12, 15, 11, 8, 3};
  for (int i = 0; i < 10; ++i) s.points.push_back({0.5 * i, steps[i], 0.3});
  const auto t = trend_of(s);
  ASSERT_TRUE(t);
  ASSERT_EQ(t->model, Model::walk);
  const Forecast f = forecast(s, *t, 6.5, {});
  EXPECT_NEAR(f.u, std::sqrt(t->covariance[0] + 2.0 * t->walk), 1e-9);
  EXPECT_NEAR(f.value, t->coefficients[0], 1e-12);
}

TEST(Forecast, OfCampaignsThatScatterMore) {
  Series s = reference_series();
  const double u = forecast(s, *trend_of(s), 4.5, {}).u;
  s.excess = 1.5;
  EXPECT_NEAR(forecast(s, *trend_of(s), 4.5, {}).u, 1.5 * u, 1e-9);
}

struct Covered {
  double state = 0.0, reading = 0.0, slope = 0.0;  ///< percent
};

/// Thousands of histories; `truth` knows the slope, 1 per year where there is one.
template <class Truth>
Covered covered(std::vector<Declared> declared, const Truth& truth) {
  std::mt19937_64 random(20261123);
  std::cout << "seed 20261123\n";
  const int trials = std::getenv("NONIO_LONG") != nullptr ? 10000 : 4000;
  constexpr double k = 1.959963984540054, u = 0.3, next = 4.5;
  Covered out;
  for (int i = 0; i < trials; ++i) {
    Series s = made_series(8, u, random, truth);
    s.declared = declared;
    const auto t = trend_of(s);
    const Forecast f = forecast(s, *t, next, 100.0);
    const double is = truth(9, next), reading = is + u * std::normal_distribution<double>()(random);
    const Segment& last = t->segments.back();
    out.state += std::fabs(is - f.value) < k * f.u ? 100.0 / trials : 0.0;
    out.reading += std::fabs(reading - f.value) < k * f.u_reading ? 100.0 / trials : 0.0;
    out.slope += std::fabs(last.slope - 1.0) < k * last.u_slope ? 100.0 / trials : 0.0;
  }
  std::cout << "reading " << out.reading << ", slope " << out.slope << '\n';
  return out;
}

// A step that is none is named in one history of a hundred, and takes its intervals with it: of
// eight campaigns 93.5 to 94.4 % are covered, not 95 (docs/history.md).
void expect_about_95(double percent) {
  EXPECT_GE(percent, 93.3);
  EXPECT_LE(percent, 96.0);
}

TEST(ForecastCovers, MachinesThatDoNothing) {
  const Covered c = covered({}, [](std::size_t, double) { return 1.0; });
  expect_about_95(c.reading);
}

TEST(ForecastCovers, MachinesThatWear) {
  const Covered c = covered({}, [](std::size_t, double t) { return t; });
  expect_about_95(c.reading);
  expect_about_95(c.slope);
}

TEST(ForecastCovers, MachinesThatWearAndWereRepaired) {
  const Covered c = covered({{3, Declared::Kind::event}},
                            [](std::size_t i, double t) { return t - (i > 3 ? 2.0 : 0.0); });
  expect_about_95(c.reading);
  expect_about_95(c.slope);
}

}  // namespace
}  // namespace nonio::statistics::forecast_test
