// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "laboratory/statistics/trend.h"
#include "made.h"

namespace nonio::statistics::difference_test {
namespace {

TEST(Difference, ZetaAndEn) {
  const Series s = reference_series();
  const auto d = difference(s.points.front(), s.points.back());
  ASSERT_TRUE(d);
  EXPECT_NEAR(d->zeta(), -4.6852, 6e-5);
  EXPECT_NEAR(d->zeta() / 2.0, -2.3426, 6e-5);
  Series two;
  two.points = {s.points.front(), s.points.back()};
  const auto t = trend_of(two);
  ASSERT_EQ(t->changes.size(), 1U);
  EXPECT_NEAR(t->changes[0].size / t->changes[0].u, -4.6852, 6e-5);
}

TEST(Difference, WhatBothHaveInCommonCancels) {
  const Point a{0, 1.0, 0.3, {{"instrument 1", 2.0}}}, b{0, 2.0, 0.4, {{"instrument 1", 2.0}}},
      other{0, 2.0, 0.4, {{"instrument 2", 2.0}}}, half{0, 2.0, 0.4, {{"instrument 1", 1.0}}};
  EXPECT_NEAR(difference(a, b)->u, 0.5, 1e-12);
  EXPECT_NEAR(difference(a, other)->u, std::sqrt(0.25 + 8.0), 1e-12);
  EXPECT_NEAR(difference(a, half)->u, std::sqrt(0.25 + 1.0), 1e-12);
  EXPECT_NEAR(difference(a, b, 0.5, 1.2)->u, 1.3, 1e-12);
  EXPECT_NEAR(difference(a, b, 0.5)->value, 0.5, 1e-12);
}

TEST(Difference, WhatIsNoNumberIsRefusedByName) {
  EXPECT_NE(difference({0, 1, 0.1}, {0, NAN, 0.1}).error().message.find("point 2"),
            std::string::npos);
  EXPECT_NE(difference({0, 1, 0.0}, {0, 1, 0.1}).error().message.find("point 1"),
            std::string::npos);
  EXPECT_FALSE(difference({0, 1, 0.1}, {0, 1, 0.1}, NAN));
}

Curve coefficients(double c2, double c3) { return {{c2, c3}, {0.04, 0.01, 0.01, 0.09}, {}}; }

std::vector<std::vector<double>> places(std::size_t m) {
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < m; ++i) {
    const double z = 2.0 * static_cast<double>(i) / static_cast<double>(m - 1) - 1.0;
    out.push_back({(3 * z * z - 1) / 2, (5 * z * z * z - 3 * z) / 2});
  }
  return out;
}

TEST(Difference, OfCurvesFromTheirCoefficients) {
  const auto before = seen_through(coefficients(1.0, 0.0), places(11)),
             after = seen_through(coefficients(1.5, 1.0), places(11));
  ASSERT_TRUE(before && after);
  const auto d = difference(*before, *after);
  ASSERT_TRUE(d);
  EXPECT_NEAR(d->values.back(), 1.5, 1e-12);  // P2(1) = P3(1) = 1
  EXPECT_NEAR(d->u.back(), std::sqrt(2 * (0.04 + 0.09 + 2 * 0.01)), 1e-12);
  EXPECT_NEAR(d->u.front(), std::sqrt(2 * (0.04 + 0.09 - 2 * 0.01)), 1e-12);
  // Eleven places say no more than two coefficients: (0.5, 1) (2 C)^-1 (0.5, 1)'.
  EXPECT_EQ(d->dof, 2.0);
  const double det = 4 * (0.04 * 0.09 - 0.01 * 0.01);
  EXPECT_NEAR(d->chi2, (0.25 * 0.18 - 2 * 0.5 * 0.02 + 0.08) / det, 1e-9);
  const auto of_coefficients = difference(coefficients(1.0, 0.0), coefficients(1.5, 1.0));
  EXPECT_NEAR(of_coefficients->chi2, d->chi2, 1e-9);
  // As expected: nothing is left.
  EXPECT_NEAR(difference(*before, *after, d->values)->chi2, 0.0, 1e-12);
}

TEST(Difference, OfCurvesThatShareAnInstrument) {
  Curve a{{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {{"instrument 1", {1, 2, 3}}}}, b = a, other = a;
  b.values = {1, 2, 3};
  other.common[0].source = "instrument 2";
  EXPECT_NEAR(difference(a, b)->u[2], std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(difference(a, other)->u[2], std::sqrt(2.0 + 18.0), 1e-12);
  EXPECT_EQ(difference(a, b)->largest, 2U);
  // Three places are looked at.
  EXPECT_NEAR(difference(a, b)->p_largest, 3 * std::erfc(3 / std::sqrt(2.0) / std::sqrt(2.0)),
              1e-12);
}

TEST(Difference, CurvesOfOtherPlacesAreRefused) {
  const Curve a{{1, 2}, {1, 0, 0, 1}, {}}, b{{1}, {1}, {}};
  EXPECT_FALSE(difference(a, b));
  EXPECT_FALSE(difference(a, a, {1}));
  EXPECT_FALSE(difference(a, Curve{{1, NAN}, {1, 0, 0, 1}, {}}));
  EXPECT_FALSE(difference(a, Curve{{1, 2}, {1, 0, 0}, {}}));
  EXPECT_FALSE(difference(Curve{{1, 2}, {0, 0, 0, 0}, {}}, Curve{{1, 2}, {0, 0, 0, 0}, {}}));
  EXPECT_FALSE(seen_through(a, {{1, 2, 3}}));
}

TEST(Difference, OfCurvesByChance) {
  std::mt19937_64 random(20261124);
  std::cout << "seed 20261124\n";
  std::normal_distribution<double> noise;
  constexpr int trials = 10000;
  int news = 0;
  for (int i = 0; i < trials; ++i) {
    Curve a, b;
    const double instrument = 3.0 * noise(random);
    for (Curve* c : {&a, &b}) {
      const double x = noise(random), y = noise(random);
      c->values = {x + instrument, 0.6 * x + 0.8 * y - instrument};
      c->covariance = {1.0, 0.6, 0.6, 1.0};
      c->common = {{"instrument", {3.0, -3.0}}};
    }
    news += difference(a, b)->p < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(100.0 * news / trials, 5.0, 0.7);
}

TEST(Table, DidWhatItPromised) {
  const Point found{0, 12.0, 0.3, {{"instrument 1", 2.0}}},
      left{0, 0.5, 0.3, {{"instrument 1", 2.0}}};
  const auto good = check_table(found, left, -12.0, 0.1);
  ASSERT_TRUE(good);
  EXPECT_TRUE(good->as_promised);
  EXPECT_NEAR(good->beside.value, 0.5, 1e-12);
  EXPECT_NEAR(good->beside.u, std::sqrt(0.09 + 0.09 + 0.01), 1e-12);
  EXPECT_NEAR(*good->taken, 1.0 - 0.5 / 12.0, 1e-12);
  // Entered with the wrong sign: twice the error.
  const auto wrong = check_table(found, {0, 24.0, 0.3, {{"instrument 1", 2.0}}}, -12.0, 0.1);
  EXPECT_FALSE(wrong->as_promised);
  EXPECT_LT(*wrong->taken, -0.9);
  // Never entered.
  EXPECT_FALSE(check_table(found, found, -12.0)->as_promised);
  // Of an error that could not be seen nothing is said.
  EXPECT_FALSE(check_table({0, 0.5, 0.3}, {0, 0.1, 0.3}, 0.0)->taken);
  EXPECT_FALSE(check_table(found, {0, 0.5, 0.0}, 0.0));
}

TEST(Table, OfGoodTablesOneInAHundredIsDoubted) {
  std::mt19937_64 random(20261125);
  std::cout << "seed 20261125\n";
  std::normal_distribution<double> noise;
  constexpr int trials = 20000;
  int doubted = 0;
  for (int i = 0; i < trials; ++i) {
    const double shared = 2.0 * noise(random), rounding = 0.1 * noise(random);
    const Point found{0, 12 + shared + 0.3 * noise(random), 0.3, {{"i", 2.0}}},
        left{0, shared + rounding + 0.4 * noise(random), 0.4, {{"i", 2.0}}};
    doubted += check_table(found, left, -12.0, 0.1)->as_promised ? 0 : 1;
  }
  EXPECT_NEAR(100.0 * doubted / trials, 1.0, 0.25);
}

}  // namespace
}  // namespace nonio::statistics::difference_test
