// SPDX-License-Identifier: Apache-2.0
// What a series did: reference values, and what must fail for wrong work.
#include "laboratory/statistics/trend.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <iostream>

#include "laboratory/statistics/forecast.h"
#include "made.h"

namespace nonio::statistics::trend_test {
namespace {

TEST(Trend, ALineIsNotTakenForAStep) {
  const auto t = trend_of(reference_series());
  ASSERT_TRUE(t);
  EXPECT_EQ(t->model, Model::drift);
  EXPECT_TRUE(t->changes.empty());
  EXPECT_NEAR(t->segments.front().slope, -0.42385, 6e-6);
  EXPECT_NEAR(t->segments.front().u_slope, 0.07140, 6e-6);
}

Series stepped(std::size_t n, std::size_t after, double size) {
  Series s;
  for (std::size_t i = 0; i < n; ++i)
    s.points.push_back(
        {0.5 * static_cast<double>(i), (i > after ? size : 0.0) + (i % 2 == 0 ? 0.1 : -0.1), 0.2});
  return s;
}

TEST(Trend, ALargeStepIsNamedWithItsPlaceAndSize) {
  for (const std::size_t after : {0U, 3U, 6U}) {
    const auto t = trend_of(stepped(8, after, -4.0));
    ASSERT_TRUE(t);
    EXPECT_EQ(t->model, Model::step);
    ASSERT_EQ(t->changes.size(), 1U);
    EXPECT_EQ(t->changes[0].after, after);
    EXPECT_NEAR(t->changes[0].size, -4.0, 0.2);
    EXPECT_EQ(t->changes[0].cause, Change::Cause::undeclared);
    EXPECT_LT(t->changes[0].p, 1e-9);
    EXPECT_EQ(t->segments.size(), 2U);
  }
}

TEST(Trend, StepsAreThoseThatTwoCampaignsShow) {
  // A drift with steps against it fits these as well, with changes between equal values.
  for (const std::vector<double>& values : {std::vector{1.90, 1.97, 2.06, 5.07, 7.97, 10.03},
                                            std::vector{2., 2., 4., 4., 4., 4., 4., 6.}}) {
    Series s;
    for (std::size_t i = 0; i < values.size(); ++i)
      s.points.push_back({0.5 * static_cast<double>(i), values[i], 0.07});
    const auto t = trend_of(s);
    ASSERT_TRUE(t);
    ASSERT_FALSE(t->changes.empty());
    for (const Change& c : t->changes)
      EXPECT_NEAR(c.size, values[c.after + 1] - values[c.after], 0.3) << c.after;
  }
}

TEST(Trend, TwoPointsAreCompared) {
  const auto t = trend_of(stepped(2, 0, 4.0));
  ASSERT_TRUE(t);
  EXPECT_EQ(t->model, Model::none);  // a difference, no model
  ASSERT_EQ(t->changes.size(), 1U);
  EXPECT_NEAR(t->changes[0].size, 3.8, 1e-12);
  EXPECT_NEAR(t->changes[0].u, 0.2 * std::sqrt(2.0), 1e-12);
}

TEST(Trend, AStepAtADeclaredEventIsItsOwn) {
  Series s = stepped(8, 3, -4.0);
  s.declared = {{3, Declared::Kind::event}};
  const auto t = trend_of(s);
  ASSERT_TRUE(t);
  ASSERT_EQ(t->changes.size(), 1U);
  EXPECT_EQ(t->changes[0].cause, Change::Cause::event);
  EXPECT_EQ(t->changes[0].declared, std::optional<std::size_t>(0));
  EXPECT_NE(t->model, Model::step);
}

TEST(Trend, AnInstrumentsJumpIsNotTheMachines) {
  Series s = stepped(8, 3, 0.6);  // two of the uncertainties that its certificates state
  s.declared = {{3, Declared::Kind::instrument}};
  for (std::size_t i = 0; i < 8; ++i)
    s.points[i].common = {{i <= 3 ? "instrument 1" : "instrument 2", 0.3}};
  const auto small = trend_of(s);
  ASSERT_TRUE(small);
  EXPECT_TRUE(small->changes.empty());
  for (std::size_t i = 4; i < 8; ++i) s.points[i].value += 4.0;
  const auto large = trend_of(s);
  ASSERT_EQ(large->changes.size(), 1U);
  EXPECT_EQ(large->changes[0].cause, Change::Cause::instrument);
}

TEST(Trend, WhatAllHaveInCommonChangesNoSlope) {
  Series s = reference_series();
  const auto without = trend_of(s);
  for (Point& p : s.points) p.common = {{"instrument 1", 0.30}};
  const auto with = trend_of(s);
  ASSERT_TRUE(with && without);
  EXPECT_NEAR(with->segments[0].slope, without->segments[0].slope, 1e-12);
  EXPECT_NEAR(with->segments[0].u_slope, without->segments[0].u_slope, 1e-12);
  EXPECT_GT(with->segments[0].u_first, without->segments[0].u_first);
}

TEST(Trend, FollowsShiftsAndUnits) {
  Series s = reference_series(), moved = s, scaled = s;
  for (Point& p : moved.points) p.time += 17.0, p.value += 3.0;
  for (Point& p : scaled.points) p.value *= 1e-6, p.u *= 1e-6;
  const auto a = trend_of(s), b = trend_of(moved), c = trend_of(scaled);
  EXPECT_NEAR(b->segments[0].last, a->segments[0].last + 3.0, 1e-9);
  EXPECT_NEAR(c->segments[0].last, 1e-6 * a->segments[0].last, 1e-15);
  EXPECT_NEAR(*c->smallest_change, 1e-6 * *a->smallest_change, 1e-15);
}

std::string refusal(const Series& s) {
  const auto t = trend_of(s);
  return t ? "" : t.error().message;
}

TEST(Trend, WhatIsNoSeriesIsRefusedByName) {
  Series s = reference_series();
  s.points[2].value = NAN;
  EXPECT_NE(refusal(s).find("point 3"), std::string::npos);
  s = reference_series();
  s.points[4].u = 0.0;
  EXPECT_NE(refusal(s).find("point 5"), std::string::npos);
  s = reference_series();
  s.points[1].time = -1.0;
  EXPECT_NE(refusal(s).find("point 2"), std::string::npos);
  s = reference_series();
  s.declared = {{7, Declared::Kind::event}};
  EXPECT_FALSE(trend_of(s));
  EXPECT_FALSE(trend_of({}));
  s.declared.clear(), s.points.resize(1);
  EXPECT_EQ(trend_of(s)->model, Model::none);
}

TEST(Trend, TwiceTheSame) {
  const auto a = trend_of(stepped(8, 3, 0.5)), b = trend_of(stepped(8, 3, 0.5));
  EXPECT_EQ(a->coefficients, b->coefficients);
  EXPECT_EQ(a->changes.size(), b->changes.size());
}

// Each with its own noise: rates, not examples.
struct Rates {
  double news = 0.0, right = 0.0;
};

template <class Truth>
Rates rates(std::size_t n, std::optional<std::size_t> after, const Truth& truth, unsigned seed) {
  std::mt19937_64 random(seed);
  std::cout << "seed " << seed << '\n';
  constexpr int trials = 2000;
  Rates out;
  for (int i = 0; i < trials; ++i) {
    const auto t = trend_of(made_series(n, 0.3, random, truth));
    const bool news = t->model == Model::step;
    out.news += news ? 1.0 / trials : 0.0;
    out.right += news && after && t->changes.size() == 1 && t->changes[0].after == *after
                     ? 1.0 / trials
                     : 0.0;
  }
  return out;
}

TEST(Trend, QuietMachinesAreSeldomNews) {
  for (const std::size_t n : {3U, 5U, 8U, 15U}) {
    const Rates r = rates(
        n, {}, [](std::size_t, double) { return 1.0; }, 100 + static_cast<unsigned>(n));
    EXPECT_LT(r.news, 0.018) << n;
  }
}

// Of one day, so that no drift competes: the p of the largest of seven places at its 1 %, within
// the bounds of chance (three standard deviations of 10,000).
TEST(Trend, TheLargestOfManyPlacesIsChanceInOneOfAHundred) {
  std::mt19937_64 random(20261127);
  std::cout << "seed 20261127\n";
  constexpr int trials = 10000;
  int news = 0;
  for (int i = 0; i < trials; ++i) {
    Series s = made_series(8, 0.3, random, [](std::size_t, double) { return 1.0; });
    for (Point& p : s.points) p.time = 0.0;
    news += trend_of(s)->model == Model::step ? 1 : 0;
  }
  EXPECT_NEAR(100.0 * news / trials, 1.0, 0.3);
}

TEST(Trend, SeveralOfOneDayHaveNoSlope) {
  Series s = reference_series();
  for (Point& p : s.points) p.time = 2.0;
  const auto t = trend_of(s);
  ASSERT_TRUE(t);
  EXPECT_FALSE(t->drifts);
  EXPECT_TRUE(std::isfinite(t->segments.back().last));
}

TEST(Trend, OrderOfWhatIsKnownDoesNotMatter) {
  Series a = stepped(8, 3, 2.0), b;
  for (Point& p : a.points) p.common = {{"instrument 1", 0.3}, {"expansion of axis X", -0.1}};
  a.declared = {{3, Declared::Kind::event}, {5, Declared::Kind::table}};
  b = a;
  for (Point& p : b.points) std::swap(p.common[0], p.common[1]);
  std::swap(b.declared[0], b.declared[1]);
  const auto x = trend_of(a), y = trend_of(b);
  ASSERT_TRUE(x && y);
  ASSERT_EQ(x->changes.size(), y->changes.size());
  for (std::size_t k = 0; k < x->changes.size(); ++k) {
    EXPECT_EQ(x->changes[k].after, y->changes[k].after);
    EXPECT_NEAR(x->changes[k].size, y->changes[k].size, 1e-12);
  }
  EXPECT_NEAR(x->segments.back().last, y->segments.back().last, 1e-12);
}

TEST(Trend, WearIsNoStep) {
  const Rates r = rates(
      10, {}, [](std::size_t, double t) { return 0.8 * t; }, 201);
  EXPECT_LT(r.news, 0.03);
}

TEST(Trend, WhatWandersIsNoRowOfCrashes) {
  std::mt19937_64 random(601);
  std::cout << "seed 601\n";
  constexpr int trials = 400;
  int walks = 0, steps = 0;
  for (int i = 0; i < trials; ++i) {
    double is = 0.0;
    const Series s = made_series(25, 0.3, random, [&](std::size_t, double) {
      return is += 0.7 * std::normal_distribution<double>()(random);
    });
    const auto t = trend_of(s);
    walks += t->model == Model::walk ? 1 : 0;
    steps += t->changes.size() > 1 ? 1 : 0;
  }
  EXPECT_GT(walks, trials / 2);
  EXPECT_LT(steps, trials / 2);
}

TEST(Trend, ACrashAndItsRepairAreNoWalk) {
  const auto back = [](std::size_t i, double) { return i > 5 && i < 11 ? 6 * 0.3 : 0.0; };
  std::mt19937_64 random(602);
  std::cout << "seed 602\n";
  int steps = 0;
  for (int i = 0; i < 400; ++i) {
    const auto t = trend_of(made_series(16, 0.3, random, back));
    steps += t->model == Model::step && t->changes.size() >= 2 ? 1 : 0;
  }
  EXPECT_GT(steps, 380);
}

TEST(Trend, LargeStepsAreFoundWhereTheyAre) {
  const Rates r = rates(
      10, 5, [](std::size_t i, double) { return i > 5 ? 6 * 0.3 : 0.0; }, 301);
  EXPECT_GT(r.news, 0.97);
  EXPECT_GT(r.right, 0.9);
}

TEST(Trend, TheSmallestChangeIsFoundEightTimesInTen) {
  std::mt19937_64 random(401);
  std::cout << "seed 401\n";
  const auto quiet = trend_of(made_series(8, 0.3, random, [](std::size_t, double) { return 0.0; }));
  ASSERT_TRUE(quiet->smallest_change);
  const double size = *quiet->smallest_change;
  const Rates r = rates(
      8, 6, [&](std::size_t i, double) { return i > 6 ? size : 0.0; }, 402);
  EXPECT_NEAR(r.news, 0.8, 0.1);
}

TEST(ExcessScatter, IsThatOfTheLaboratory) {
  std::mt19937_64 random(501);
  std::cout << "seed 501\n";
  std::vector<Series> all;
  for (int i = 0; i < 40; ++i) {
    all.push_back(made_series(8, 0.45, random,
                              [&](std::size_t k, double) { return i < 4 && k > 3 ? 9.0 : 0.0; }));
    for (Point& p : all.back().points) p.u = 0.3;
  }
  std::vector<double> ratios;
  for (const Series& s : all)
    for (const Scatter& one : scatter_of(s)) ratios.push_back(one.ratio);
  EXPECT_NEAR(excess_of_ratios(ratios), 1.5, 0.2);
  EXPECT_LT(p_of_ratios(ratios), 0.001);
  ratios.resize(10);
  EXPECT_EQ(excess_of_ratios(ratios), 1.0);  // too few to say
}

TEST(ExcessScatter, OfNoiseIsSignificantAsOftenAsStated) {
  std::mt19937_64 random(502);
  std::cout << "seed 502\n";
  const int trials = 4000;
  int below = 0, high = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> ratios;
    for (int i = 0; i < 8; ++i) {
      Series s = made_series(6, 0.3, random, [](std::size_t, double) { return 0.0; });
      for (Point& p : s.points) p.u = 0.3;
      for (const Scatter& one : scatter_of(s)) ratios.push_back(one.ratio);
    }
    below += p_of_ratios(ratios) < 0.01;
    high += excess_of_ratios(ratios) > 1.2;
  }
  EXPECT_LT(below, 0.015 * trials);
  EXPECT_GT(high, 0.1 * trials);  // the factor alone says little
}

TEST(SpreadOfSlopes, HoldsASlopeWhereAStepIsTestedAndNotWhereItIsKnown) {
  Series s = reference_series();
  s.spread = 0.3;
  s.declared = {{4, Declared::Kind::event}};
  const auto trend = trend_of(s);
  ASSERT_TRUE(trend);
  ASSERT_EQ(trend->changes.size(), 1U);
  // X'WX b = X'Wy of level, step and slope, the slope with and without a row slope/spread = 0.
  const auto z_and_slope = [&](double held) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      const Eigen::Vector3d x(1.0, i > 4 ? 1.0 : 0.0, s.points[i].time);
      normal += x * x.transpose() / (s.points[i].u * s.points[i].u);
      right += x * s.points[i].value / (s.points[i].u * s.points[i].u);
    }
    normal(2, 2) += held;
    const Eigen::Matrix3d C = normal.inverse();
    const Eigen::Vector3d b = C * right;
    return std::array{b(1) / std::sqrt(C(1, 1)), b(2), std::sqrt(C(2, 2))};
  };
  const auto held = z_and_slope(1.0 / (s.spread * s.spread)), own = z_and_slope(0.0);
  EXPECT_NEAR(trend->changes[0].p, std::erfc(std::fabs(held[0]) / std::sqrt(2.0)), 1e-9);
  EXPECT_NEAR(trend->segments[0].slope, own[1], 1e-9);
  EXPECT_NEAR(trend->segments[0].u_slope, own[2], 1e-9);
  EXPECT_NEAR(trend->changes[0].size / trend->changes[0].u, held[0], 1e-9);
}

TEST(SpreadOfSlopes, ASlopeThatIsUnlikeTheOthersIsFree) {
  Series s = reference_series();
  s.spread = 0.01;  // 42 of them
  const auto trend = trend_of(s);
  ASSERT_TRUE(trend);
  EXPECT_NEAR(trend->coefficients[1], -0.42385, 5e-6);
  EXPECT_NEAR(trend->segments[0].u_slope, 0.07140, 5e-6);
}

TEST(SpreadOfSlopes, IsThatOfTheLaboratory) {
  std::mt19937_64 random(601);
  std::cout << "seed 601\n";
  std::normal_distribution<double> wear(0.0, 0.4);
  const auto slopes = [&](bool wears, bool steps) {
    std::vector<Slope> out;
    for (int i = 0; i < 100; ++i) {
      const double slope = wears ? wear(random) : 0.0;
      const auto s = made_series(8, 0.3, random, [&](std::size_t k, double time) {
        return slope * time + (steps && i < 10 && k > 3 ? 9.0 : 0.0);
      });
      if (const auto found = slope_with_steps(s)) out.push_back(*found);
    }
    return out;
  };
  EXPECT_NEAR(spread_of_slopes(slopes(true, false)), 0.4, 0.08);
  EXPECT_NEAR(spread_of_slopes(slopes(true, true)), 0.4, 0.1);
  EXPECT_LT(spread_of_slopes(slopes(false, true)), 0.1);
  EXPECT_EQ(spread_of_slopes({{5.0, 0.1}, {-5.0, 0.1}}), 0.0);  // too few to say
}

TEST(SpreadOfSlopes, SlopesAndForecastsAreCoveredWhateverTheOthersDo) {
  // One machine in four wears: the mean slope of the others says nothing of its own.
  std::mt19937_64 random(602);
  std::cout << "seed 602\n";
  constexpr int series = 8000;
  for (const double wear : {0.0, 0.8}) {
    int slopes = 0, states = 0;
    for (int i = 0; i < series; ++i) {
      auto s = made_series(6, 0.3, random, [&](std::size_t, double time) { return wear * time; });
      s.spread = 0.4;
      s.steps.emplace();  // none are sought: their coverage is in bench/history_statistics
      const auto trend = trend_of(s);
      ASSERT_TRUE(trend);
      const double ahead = s.points.back().time + 0.5;
      const Forecast f = forecast(s, *trend, ahead, std::nullopt);
      slopes +=
          std::fabs(trend->segments.back().slope - wear) < 1.96 * trend->segments.back().u_slope;
      states += std::fabs(f.value - wear * ahead) < 1.96 * f.u;
    }
    // 0.24 % is one standard deviation.
    EXPECT_NEAR(slopes, 0.95 * series, 0.009 * series) << wear;
    EXPECT_NEAR(states, 0.95 * series, 0.009 * series) << wear;
  }
}

TEST(Trend, KnownStepsAreTheOnlyOnes) {
  std::mt19937_64 random(603);
  std::cout << "seed 603\n";
  Series s = made_series(10, 0.1, random, [](std::size_t k, double) { return k > 6 ? 3.0 : 0.0; });
  ASSERT_EQ(trend_of(s)->changes.size(), 1U);
  s.steps = {2};
  const auto trend = trend_of(s);
  ASSERT_EQ(trend->changes.size(), 1U);
  EXPECT_EQ(trend->changes[0].after, 2U);
  EXPECT_EQ(trend->model, Model::step);
  s.steps = {9};
  EXPECT_FALSE(trend_of(s));
  s.steps.emplace();
  EXPECT_TRUE(trend_of(s)->changes.empty());
}

}  // namespace
}  // namespace nonio::statistics::trend_test
