// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/table_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace nonio::statistics::table_change_test {
namespace {

using Curve = std::function<double(double)>;

const std::vector<double> places{0, 50, 100, 150, 200, 250, 300, 350, 400, 450, 500};

double error(double x) { return 0.02 * x + 5.0 * std::sin(x / 80.0); }

TableCurve table_of(const Curve& c) {
  TableCurve t{places, {}, {}};
  for (const double x : places) t.plus.push_back(c(x));
  return t;
}

MeasuredCurve measured(const Curve& c, unsigned seed, double u = 0.1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, u);
  MeasuredCurve m{places, {}, {}, u};
  for (const double x : places) {
    m.plus.push_back(c(x) + noise(random));
    m.minus.push_back(c(x) + 4.0 + noise(random));
  }
  return m;
}

TEST(TableChange, ATableOfAWholeTurnRepeats) {
  TableCurve t;
  for (int i = 0; i <= 12; ++i) {
    t.position.push_back(30.0 * i);
    t.plus.push_back(i == 12 ? 0.0 : 10.0 * std::sin(30.0 * i / 57.29577951308232));
  }
  TableCurve held = t;
  t.repeat_after(360.0);
  for (const double x : {-180.0, -90.0, -15.0, 45.0, 390.0, 725.0}) {
    const double within = x - 360.0 * std::floor(x / 360.0);
    EXPECT_NEAR(t.at(x, 1), held.at(within, 1), 1e-9) << x;
    EXPECT_NEAR(t.shifted(2).at(x + 60.0, 1), t.at(x, 1), 1e-9) << x;
  }
  EXPECT_EQ(held.at(-90.0, 1), 0.0);
  held.plus.back() = 1.0;  // an open table holds its ends
  held.repeat_after(360.0);
  EXPECT_EQ(held.turn, 0.0);
}

std::optional<TableChange> found(const Curve& before, const Curve& after,
                                 const std::optional<TableCurve>& active,
                                 const std::vector<TableCurve>& known) {
  return recognize(measured(before, 1), measured(after, 2), active, known, 5e-4, 0.1);
}

const TableCurve T = table_of([](double x) { return -error(x); });
const TableCurve S = table_of([](double x) { return 3.0 * std::cos(x / 60.0) - 0.01 * x; });

TEST(TableChange, EachWayOfLoadingHasItsName) {
  const TableCurve none;
  const auto adding = [](double of_T, double of_S, int points = 0) {
    return
        [=](double x) { return error(x) + of_T * T.shifted(points).at(x, 1) + of_S * S.at(x, 1); };
  };
  struct Case {
    double of_T, of_S;
    int points;
    bool with_S;
    Loading loading;
  };
  for (const Case& c : {Case{1, 0, 0, false, Loading::loaded},
                        {-1, 0, 0, false, Loading::wrong_sign},
                        {2, 0, 0, false, Loading::twice},
                        {1, 0, 2, false, Loading::offset},
                        {1, 0, -3, false, Loading::offset},
                        {1, 0, 0, true, Loading::loaded},
                        {-1, 0, 0, true, Loading::wrong_sign},
                        {1, 1, 0, true, Loading::in_addition},
                        {0, 0, 0, true, Loading::removed}}) {
    const auto one = found(adding(0, c.with_S ? 1.0 : 0.0), adding(c.of_T, c.of_S, c.points),
                           c.with_S ? S : none, {S, T});
    ASSERT_TRUE(one) << c.of_T << " " << c.of_S << " " << c.points;
    EXPECT_EQ(one->loading, c.loading) << c.of_T << " " << c.of_S << " " << c.points;
    EXPECT_EQ(one->points, c.points);
    if (c.loading != Loading::removed) EXPECT_EQ(one->table, 1U);
    EXPECT_LT(one->left, 0.4);
    EXPECT_GT(one->rms, 1.0);
  }
}

TEST(TableChange, WhatIsNoTableHasNoName) {
  const TableCurve none;
  EXPECT_FALSE(found(error, error, none, {S, T}));
  EXPECT_FALSE(found(error, [](double x) { return error(x) - 0.02 * x; }, none, {S, T})) << "scale";
  EXPECT_FALSE(found(error, [](double x) { return 0.6 * error(x); }, none, {S, T})) << "a part";
  EXPECT_FALSE(
      found(error, [](double x) { return error(x) + 9.0 * std::exp(-x / 100.0); }, none, {S, T}));
  EXPECT_FALSE(found(error, [](double x) { return error(x) + T.at(x, 1); }, none, {}));
}

/// Wear in addition to a table that was loaded: no name, but the table that explains most, and what remains.
TEST(TableChange, WearInAdditionToATableIsWhatRemains) {
  const auto wear = [](double x) { return 2.0 * std::sin(x / 40.0); };
  const auto before = measured(error, 1);
  const auto after = measured([&](double x) { return error(x) + T.at(x, 1) + wear(x); }, 2);
  EXPECT_FALSE(recognize(before, after, TableCurve{}, {S, T}, 5e-4, 0.1));
  const auto near = nearest(before, after, TableCurve{}, {S, T}, 0.1);
  ASSERT_TRUE(near);
  EXPECT_EQ(near->table, 1U);
  double mean = 0.0, squares = 0.0;
  for (const double x : places) mean += wear(x) / static_cast<double>(places.size());
  for (const double x : places)
    squares += (wear(x) - mean) * (wear(x) - mean) / static_cast<double>(places.size());
  EXPECT_NEAR(near->left, std::sqrt(squares), 0.15);
  EXPECT_GT(near->rms, 2.0 * near->left);
}

TEST(TableChange, AConstantAndTheUncertaintyOfTheScaleAreNoRest) {
  const auto one = found(error, [](double x) { return 7.0 + 4e-4 * x; }, TableCurve{}, {T});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->loading, Loading::loaded);
}

TEST(TableChange, WithoutRepeatsTheNoiseIsThatOfTheReversal) {
  MeasuredCurve before = measured(error, 3, 0.4),
                after = measured([](double) { return 0.0; }, 4, 0.4);
  before.u = after.u = 0.0;
  const auto one = recognize(before, after, TableCurve{}, {T}, 5e-4, 0.1);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->loading, Loading::loaded);
}

TEST(TableChange, AnOffsetMovesTheEntriesAndHoldsTheEnd) {
  const TableCurve up = T.shifted(2);
  EXPECT_DOUBLE_EQ(up.at(100.0, 1), T.at(0.0, 1));
  EXPECT_DOUBLE_EQ(up.at(0.0, 1), T.at(0.0, 1));
  EXPECT_DOUBLE_EQ(up.at(500.0, -1), T.at(400.0, 1));
}

}  // namespace
}  // namespace nonio::statistics::table_change_test
