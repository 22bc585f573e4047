// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "axis_builder.h"
#include "nonio/math/vdi3441.h"

namespace nonio::math::distributions_test {
namespace {

// Closed forms: F with 2 degrees above has P(F > f) = (1 + 2 f/n)^(-n/2); t with 1 degree is
// Cauchy's, with 2 has P(|T| > t) = 1 - t/sqrt(t^2 + 2).
TEST(Distributions, ClosedForms) {
  for (const double f : {0.1, 1.0, 3.7, 99.0})
    for (const double n : {2.0, 5.0, 80.0})
      EXPECT_NEAR(f_upper(f, 2.0, n), std::pow(1.0 + 2.0 * f / n, -n / 2.0), 1e-13);
  for (const double t : {-63.0, -0.5, 0.0, 2.0, 1e4}) {
    EXPECT_NEAR(t_two_sided(t, 1.0), 1.0 - 2.0 / std::numbers::pi * std::atan(std::fabs(t)), 1e-12);
    EXPECT_NEAR(t_two_sided(t, 2.0), 1.0 - std::fabs(t) / std::sqrt(t * t + 2.0), 1e-9);
    EXPECT_NEAR(t_two_sided(t, 7.5), f_upper(t * t, 1.0, 7.5), 1e-13);
  }
  // The tables' 1 % points: F(4, 8) 7.01, t(8) 3.355
  EXPECT_NEAR(f_upper(7.006, 4.0, 8.0), 0.01, 1e-5);
  EXPECT_NEAR(t_two_sided(3.3554, 8.0), 0.01, 1e-6);
}

// The probability of a NaN is NaN: 1 would state that it is not significant.
TEST(Distributions, WhatIsNotANumberIsNotPassedOver) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(f_upper(nan, 2, 2)));
  EXPECT_EQ(f_upper(3, 0, 2), 1.0);
  EXPECT_EQ(f_upper(3, 2, -1), 1.0);
  EXPECT_TRUE(std::isnan(f_upper(3, 2, nan)));
  EXPECT_TRUE(std::isnan(f_upper(3, nan, 2)));
  EXPECT_EQ(f_upper(infinite, 2, 2), 0.0);
  EXPECT_TRUE(std::isnan(t_two_sided(nan, 3)));
  EXPECT_TRUE(std::isnan(t_two_sided(2, nan)));
  EXPECT_EQ(t_two_sided(2, 0), 1.0);
  EXPECT_EQ(t_two_sided(-infinite, 3), 0.0);
  EXPECT_TRUE(significant(nan, 0.01));
  EXPECT_TRUE(significant(0.009, 0.01));
  EXPECT_FALSE(significant(0.01, 0.01));
  // Readings that neither scatter nor differ are no case of it; those that differ without scatter
  // are as clear as can be.
  EXPECT_EQ(f_upper(test_ratio(0.0, 0.0), 2, 2), 1.0);
  EXPECT_EQ(t_two_sided(test_ratio(0.0, 0.0), 3), 1.0);
  EXPECT_EQ(f_upper(test_ratio(1.0, 0.0), 2, 2), 0.0);
  EXPECT_TRUE(std::isnan(test_ratio(nan, 0.0)));
}

// d_n = integral of 1 - (1 - Phi)^n - Phi^n: the mean range of n normal values.
double mean_range(int n) {
  double sum = 0.0;
  constexpr double step = 1e-3;
  for (double x = -9.0; x <= 9.0; x += step) {
    const double Phi = 0.5 * std::erfc(-x / std::numbers::sqrt2);
    sum += step * (1.0 - std::pow(1.0 - Phi, n) - std::pow(Phi, n));
  }
  return sum;
}

TEST(Distributions, TheTableOfRangesIsRight) {
  for (int n = 2; n <= 10; ++n) {
    Observations o;
    for (int k = 0; k < n; ++k)
      for (const int d : {1, -1})
        made::add(o, 0.0, d, k == 0 ? 1.0 : 0.0, static_cast<std::uint32_t>(k + 1));
    const auto r = evaluate_vdi3441(AxisTest::arrange(o), StandardDeviation::from_range);
    EXPECT_NEAR(1.0 / r.points.at(0).S, mean_range(n), 1e-11) << n;
  }
}

}  // namespace
}  // namespace nonio::math::distributions_test
