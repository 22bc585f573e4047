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

TEST(Table, DidWhatItPromised) {
  const Point found{0, 12.0, 0.3, {{"instrument 1", 2.0}}},
      left{0, 0.5, 0.3, {{"instrument 1", 2.0}}};
  const auto good = check_table(found, left, -12.0, 0.1);
  ASSERT_TRUE(good);
  EXPECT_TRUE(good->as_promised);
  EXPECT_NEAR(good->from_predicted.value, 0.5, 1e-12);
  EXPECT_NEAR(good->from_predicted.u, std::sqrt(0.09 + 0.09 + 0.01), 1e-12);
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
