// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/measuring_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nonio::math::measuring_path_test {
namespace {

using Places = std::vector<std::vector<double>>;

Places where(const MeasuringPath& path, bool read) {
  Places out;
  for (const MeasuringMove& m : path.moves)
    if ((m.dwell > 0.0) == read) out.push_back(m.to);
  return out;
}

void expect_near(const Places& found, const Places& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t a = 0; a < found[i].size(); ++a)
      EXPECT_NEAR(found[i][a], wanted[i][a], 1e-12) << i << " " << a;
}

MeasuringRequest wish(int runs, double over, bool both = true) {
  return {runs, 2.0, over, both, 1e-6};
}

TEST(MeasuringPath, AxisUpAndDownWithTurningPoints) {
  const MeasuringPath p = axis_path("X", false, {0.1, 0.2, 0.3}, wish(2, 0.01));
  const Places run = {{.1}, {.2}, {.3}, {.3}, {.2}, {.1}};
  Places twice = run;
  twice.insert(twice.end(), run.begin(), run.end());
  expect_near(where(p, true), twice);
  expect_near(where(p, false), {{.09}, {.31}, {.09}, {.31}, {.09}});
  for (const MeasuringMove& m : p.moves) EXPECT_TRUE(m.dwell == 0.0 || m.dwell == 2.0);
}

TEST(MeasuringPath, EveryTargetIsReachedFromItsSide) {
  const MeasuringPath p = axis_path("X", false, {0.1, 0.2, 0.3}, wish(1, 0.01));
  for (std::size_t i = 1; i < p.moves.size(); ++i)
    EXPECT_NE(p.moves[i].to[0], p.moves[i - 1].to[0]) << i;
}

TEST(MeasuringPath, OneDirectionGoesBackBeforeEachRun) {
  const MeasuringPath p = axis_path("X", false, {0.1, 0.2}, wish(2, 0.01, false));
  expect_near(where(p, true), {{.1}, {.2}, {.1}, {.2}});
  expect_near(where(p, false), {{.09}, {.09}, {.09}});
}

TEST(MeasuringPath, Diagonals) {
  Rectangle r{"X", "Y", 0.1, 0.2, 0.04, 0.03, 2};
  const auto paths = diagonal_paths(r, wish(1, 0.02));
  ASSERT_EQ(paths.size(), 2u);
  expect_near(where(paths[0], true),
              {{.1, .2}, {.14, .23}, {.18, .26}, {.18, .26}, {.14, .23}, {.1, .2}});
  expect_near(where(paths[0], false), {{.08, .185}, {.2, .275}, {.08, .185}});
  expect_near(where(paths[1], true),
              {{.1, .26}, {.14, .23}, {.18, .2}, {.18, .2}, {.14, .23}, {.1, .26}});
  expect_near(where(paths[1], false), {{.08, .275}, {.2, .185}, {.08, .275}});
  r.n = 4;
  expect_near(where(half_diagonal_path(r, wish(1, 0.02, false)), true),
              {{.1, .2}, {.18, .23}, {.26, .26}});
}

TEST(MeasuringPath, StepDiagonals) {
  const Volume v{{"X", "Y", "Z"}, {0.0, 0.1, -0.4}, {0.02, 0.03, 0.04}, 2};
  const auto paths = step_diagonal_paths(v, wish(1, 0.001));
  ASSERT_EQ(paths.size(), 4u);
  EXPECT_EQ(paths[1].name, "NPP");
  expect_near(where(paths[0], true), {{0, .1, -.4},
                                      {.02, .1, -.4},
                                      {.02, .13, -.4},
                                      {.02, .13, -.36},
                                      {.04, .13, -.36},
                                      {.04, .16, -.36},
                                      {.04, .16, -.32}});
  // Of the others: start and end; each step moves one axis, X Y Z in turn.
  const Places ends = {{0, .1, -.4},  {.04, .16, -.32}, {.04, .1, -.4}, {0, .16, -.32},
                       {0, .16, -.4}, {.04, .1, -.32},  {0, .1, -.32},  {.04, .16, -.4}};
  for (std::size_t k = 0; k < 4; ++k) {
    const Places at = where(paths[k], true);
    ASSERT_EQ(at.size(), 7u);
    expect_near({at.front(), at.back()}, {ends[2 * k], ends[2 * k + 1]});
    for (std::size_t i = 1; i < at.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_EQ(std::fabs(at[i][a] - at[i - 1][a]) > 1e-9, a == (i - 1) % 3) << paths[k].name;
    EXPECT_GT(std::fabs(paths[k].moves.front().to[0] - at[0][0]), 0.0009);
  }
}

TEST(AxisTargets, AsManyAsTheStandardAsks) {
  EXPECT_EQ(axis_points(0.2), 5);
  EXPECT_EQ(axis_points(1.0), 5);
  EXPECT_EQ(axis_points(2.0), 10);
  EXPECT_EQ(axis_points(1.9), 10);
  EXPECT_EQ(axis_points(2.5), 11);
  EXPECT_EQ(axis_points(12.0), 49);
}

TEST(AxisTargets, RandomWithinTheirReach) {
  for (const double period : {0.0, 0.02, 5.0}) {
    AxisTargets w{.first = 0.05, .last = 1.05, .points = 11, .scatter = true, .period = period};
    const auto targets = axis_targets(w);
    ASSERT_TRUE(targets);
    ASSERT_EQ(targets->size(), 11u);
    const double reach = period == 0.02 ? 0.02 : 0.03;
    double largest = 0.0;
    for (std::size_t i = 0; i < 11; ++i) {
      const double offset = (*targets)[i] - (0.05 + 0.1 * static_cast<double>(i));
      EXPECT_LE(std::fabs(offset), reach + 1e-6);
      largest = std::max(largest, std::fabs(offset));
      EXPECT_NEAR((*targets)[i] * 1e6, std::round((*targets)[i] * 1e6), 1e-6);
    }
    EXPECT_GT(largest, 0.5 * reach);
    EXPECT_GE(targets->front(), 0.05);
    EXPECT_LE(targets->back(), 1.05);
    EXPECT_TRUE(std::is_sorted(targets->begin(), targets->end()));
    EXPECT_EQ(*targets, *axis_targets(w));
    w.seed = 2;
    EXPECT_NE(*targets, *axis_targets(w));
  }
}

TEST(AxisTargets, NeverBeyondTheEnds) {
  for (const double odd : {0.0004e-3, 0.0006e-3}) {
    const auto targets = axis_targets({.first = -odd, .last = 1.0 - odd, .points = 5});
    ASSERT_TRUE(targets);
    EXPECT_GE(targets->front(), -odd);
    EXPECT_LE(targets->back(), 1.0 - odd);
    EXPECT_NEAR(targets->back(), 1.0 - 1e-6, 1e-12);
  }
}

TEST(MeasuringPath, TheDiagonalsTurnWithinTheOverTravel) {
  const Rectangle r{"X", "Y", 0.0, 0.0, 0.033, 0.056, 4};
  const Places turns = where(diagonal_paths(r, wish(1, 0.01)).front(), false);
  expect_near({turns[0], turns[1]}, {{-0.005892, -0.01}, {0.132 + 0.005892, 0.224 + 0.01}});
}

TEST(AxisTargets, TheSameOnEveryComputer) {
  const auto targets = axis_targets(
      {.first = 0.0, .last = 1.0, .points = 5, .scatter = true, .resolution = 1e-6, .seed = 1});
  ASSERT_TRUE(targets);
  // mt19937_64 of seed 1 is fixed by the standard: its first number is 2469588189546311528.
  const double first = 0.075 * std::fabs(2.0 * std::ldexp(2469588189546311528.0, -64) - 1.0);
  EXPECT_NEAR(targets->front(), first, 1e-6);
}

TEST(AxisTargets, TooCloseIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const AxisTargets& w : {AxisTargets{.first = 0, .last = 1e-6, .points = 5},
                               AxisTargets{.first = 1, .last = 0, .points = 5},
                               AxisTargets{.first = 0, .last = nan, .points = 5},
                               AxisTargets{.first = 0, .last = 1, .points = 1}})
    EXPECT_FALSE(axis_targets(w));
}

}  // namespace
}  // namespace nonio::math::measuring_path_test
