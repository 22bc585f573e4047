// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/spline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nonio::math::spline_test {

namespace {

std::vector<double> spread(std::size_t count, double step, double jitter) {
  std::vector<double> x;
  for (std::size_t k = 0; k < count; ++k)
    x.push_back(step * (static_cast<double>(k) + jitter * std::sin(7.0 * static_cast<double>(k))));
  return x;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

}  // namespace

TEST(SmoothBasis, IsOrthonormalWithoutConstantAndSlope) {
  for (const double jitter : {0.0, 0.3}) {
    const auto x = spread(24, 0.05, jitter);
    for (int knots = 2; knots <= 10; ++knots) {
      const auto basis = smooth_basis(x, x, knots);
      ASSERT_TRUE(basis) << basis.error().message;
      ASSERT_EQ(basis->size(), static_cast<std::size_t>(knots));
      const std::vector<double> one(x.size(), 1.0);
      for (std::size_t a = 0; a < basis->size(); ++a) {
        EXPECT_NEAR(dot((*basis)[a], one), 0.0, 1e-12);
        EXPECT_NEAR(dot((*basis)[a], x), 0.0, 1e-12);
        for (std::size_t b = 0; b <= a; ++b)
          EXPECT_NEAR(dot((*basis)[a], (*basis)[b]), a == b ? 1.0 : 0.0, 1e-11);
      }
    }
  }
}

// A cubic is a spline on any knots: less its line over the targets it is in the span of the basis.
TEST(SmoothBasis, HoldsEveryCubic) {
  const auto x = spread(15, 0.1, 0.2);
  const auto basis = smooth_basis(x, x, 5);
  ASSERT_TRUE(basis);
  std::vector<double> cubic, left;
  for (const double v : x) cubic.push_back(1.0 - 2.0 * v + 3.0 * v * v - 4.0 * v * v * v);
  const auto line = smooth_basis(x, x, 2);  // one interval: cubics only
  ASSERT_TRUE(line);
  for (std::size_t i = 0; i < x.size(); ++i) {
    double five = 0.0, two = 0.0;
    for (const auto& column : *basis) five += dot(column, cubic) * column[i];
    for (const auto& column : *line) two += dot(column, cubic) * column[i];
    EXPECT_NEAR(five, two, 1e-12);
    left.push_back(cubic[i] - five);
  }
  // What is left is a straight line: its slope is the same everywhere.
  for (std::size_t i = 2; i < x.size(); ++i)
    EXPECT_NEAR((left[i] - left[i - 1]) / (x[i] - x[i - 1]), (left[1] - left[0]) / (x[1] - x[0]),
                1e-9);
}

// Between the targets, over a knot: second derivatives of a cubic spline are continuous.
TEST(SmoothBasis, IsSmoothAtItsKnots) {
  const auto targets = spread(21, 0.05, 0.0);  // 0..1, five knots: the middle one at 0.5
  const double h = 1e-3;
  std::vector<double> x;
  for (int k = -3; k <= 3; ++k) x.push_back(0.5 + k * h);
  const auto basis = smooth_basis(x, targets, 5);
  ASSERT_TRUE(basis);
  for (const auto& s : *basis) {
    const double before = (s[0] - 2.0 * s[1] + s[2]) / (h * h);
    const double after = (s[4] - 2.0 * s[5] + s[6]) / (h * h);
    // Third derivatives of these functions stay below 1e4, at a distance of 4 h.
    EXPECT_NEAR(before, after, 4.0 * h * 1e4);
    EXPECT_NEAR(s[3], (s[2] + s[4]) / 2.0, h * h * 1e3);
  }
}

TEST(SmoothBasis, RefusesWhatTargetsDoNotDetermine) {
  EXPECT_FALSE(smooth_basis({}, {}, 3));
  EXPECT_FALSE(smooth_basis({}, {0.0, 1.0, 2.0, 3.0}, 3));
  EXPECT_FALSE(smooth_basis({}, spread(20, 0.1, 0.0), 1));
  EXPECT_FALSE(smooth_basis({}, std::vector<double>(20, 1.0), 3));
  // Two heaps with a gap over several knots.
  std::vector<double> heaps;
  for (int k = 0; k < 10; ++k) heaps.push_back(0.001 * k);
  for (int k = 0; k < 10; ++k) heaps.push_back(1.0 + 0.001 * k);
  EXPECT_FALSE(smooth_basis({}, heaps, 10));
}

}  // namespace nonio::math::spline_test
