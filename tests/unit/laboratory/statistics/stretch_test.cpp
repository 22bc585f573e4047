// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/stretch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nonio::statistics::stretch_test {
namespace {

double at(const FittedCurve& c, double x) {
  const double z = (2.0 * x - c.over.from - c.over.to) / c.over.length();
  double sum = 0.0;
  for (std::size_t k = 0; k < c.coefficients.size(); ++k)
    sum += c.coefficients[k] * std::legendre(static_cast<unsigned>(k), z);
  return sum;
}

// (2 k + 1)/2 times the integral of curve and P_k over -1 .. 1, by the midpoint rule.
double projected(const FittedCurve& c, const Stretch& over, unsigned degree) {
  constexpr int parts = 20000;
  double sum = 0.0;
  for (int i = 0; i < parts; ++i) {
    const double w = (2.0 * i + 1.0) / parts - 1.0;
    sum += at(c, over.from + (w + 1.0) / 2.0 * over.length()) * std::legendre(degree, w);
  }
  return sum * (2.0 * degree + 1.0) / parts;
}

FittedCurve with_unit_variances(const Stretch& over, std::vector<double> coefficients) {
  const std::size_t n = coefficients.size();
  FittedCurve out{over, std::move(coefficients), std::vector<double>(n * n, 0.0),
                  std::vector<double>(n * n, 0.0)};
  for (std::size_t i = 0; i < n; ++i) out.covariance[i * n + i] = 4.0, out.share[i * n + i] = 1.0;
  return out;
}

TEST(Stretch, WhatBothCover) {
  EXPECT_DOUBLE_EQ(common_stretch({0.0, 10.0}, {2.0, 12.0}).length(), 8.0);
  EXPECT_DOUBLE_EQ(common_stretch({0.0, 1.0}, {2.0, 12.0}).length(), 0.0);
}

TEST(Stretch, OverItsOwnStretchNothingChanges) {
  const FittedCurve c = with_unit_variances({3.0, 700.0}, {1.0, -2.0, 0.5, 0.25});
  for (std::size_t k = 0; k < 4; ++k) {
    const CoefficientOver found = coefficient_over(c, c.over, k);
    EXPECT_NEAR(found.value, c.coefficients[k], 1e-13);
    EXPECT_NEAR(found.variance, 4.0, 1e-12);
    EXPECT_NEAR(found.share, 1.0, 1e-12);
  }
}

TEST(Stretch, TheSamePolynomialOverAnother) {
  constexpr unsigned seed = 20261128;
  RecordProperty("seed", static_cast<int>(seed));
  std::mt19937_64 draw(seed);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> b(8);
    for (double& x : b) x = normal(draw);
    const FittedCurve c = with_unit_variances({0.0, 800.0}, b);
    const Stretch over{40.0 * std::fabs(normal(draw)), 800.0 + 20.0 * normal(draw)};
    for (unsigned k = 0; k < 4; ++k) {
      EXPECT_NEAR(coefficient_over(c, over, k).value, projected(c, over, k), 1e-5) << seed;
      // A linear function of the coefficients: its variance by what each alone makes of it.
      double variance = 0.0;
      for (std::size_t i = 0; i < b.size(); ++i) {
        std::vector<double> one(b.size(), 0.0);
        one[i] = 1.0;
        const double part = coefficient_over(with_unit_variances(c.over, one), over, k).value;
        variance += 4.0 * part * part;
      }
      EXPECT_NEAR(coefficient_over(c, over, k).variance, variance, 1e-9 * variance) << seed;
    }
  }
}

}  // namespace
}  // namespace nonio::statistics::stretch_test
