// SPDX-License-Identifier: Apache-2.0
#include "nonio/history/forecast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "made.h"

namespace nonio::history {
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

// Intervals of machines that do nothing, and of machines that wear.
TEST(Forecast, IntervalsHold) {
  for (const double wear : {0.0, 1.0}) {
    std::mt19937_64 random(20261123);
    std::cout << "seed 20261123\n";
    constexpr int trials = 3000;
    int within = 0;
    for (int i = 0; i < trials; ++i) {
      const Series s =
          made_series(10, 0.3, random, [&](std::size_t, double t) { return wear * t; });
      const auto t = trend_of(s);
      const Forecast f = forecast(s, *t, 5.5, 100.0);
      const double reading = wear * 5.5 + 0.3 * std::normal_distribution<double>()(random);
      within += std::fabs(reading - f.value) < 1.96 * f.u_reading ? 1 : 0;
    }
    EXPECT_NEAR(100.0 * within / trials, 95.0, 1.5) << wear;
  }
}

}  // namespace
}  // namespace nonio::history
