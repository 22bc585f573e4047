// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>
#include <vector>

#include "nonio/math/straightness.h"

namespace nonio::math {
namespace {

using Values = std::vector<double>;
constexpr unsigned seed = 20261123;
constexpr StraightLine all_lines[] = {StraightLine::least_squares, StraightLine::minimum_zone,
                                      StraightLine::end_points};

Straightness about(StraightLine line, const Values& x, const Values& e) {
  auto s = straightness_about(line, x, e);
  if (!s) throw std::runtime_error(s.error().message);
  return *s;
}

double width_at(const Values& x, const Values& e, double b) {
  double most = -INFINITY, least = INFINITY;
  for (std::size_t i = 0; i < x.size(); ++i) {
    most = std::max(most, e[i] - b * x[i]);
    least = std::min(least, e[i] - b * x[i]);
  }
  return most - least;
}

/// By every pair of points: the smallest width is at the slope of one of them.
double smallest_width(const Values& x, const Values& e) {
  double best = INFINITY;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t k = i + 1; k < x.size(); ++k)
      best = std::min(best, width_at(x, e, (e[k] - e[i]) / (x[k] - x[i])));
  return best;
}

struct Line {
  Values x, e;
};

Line random_line(std::mt19937& rng) {
  std::uniform_int_distribution<std::size_t> number(3, 40);
  std::uniform_real_distribution<double> step(0.01, 0.3);
  std::normal_distribution<double> normal(0.0, 1.0);
  Line l;
  const std::size_t n = number(rng);
  double at = step(rng) - 1.0;
  for (std::size_t i = 0; i < n; ++i)
    l.x.push_back(at += step(rng)), l.e.push_back(1e-6 * normal(rng));
  return l;
}

TEST(StraightLines, FourPointsByHand) {
  // 0 2 0 1 um at 0 1 2 3 m. End points: slope 1/3, rest 0 5/3 -2/3 0: 7/3.
  // Least squares: slope (-1.5*0 - 0.5*2 + 0.5*0 + 1.5*1)/5 = 0.1: rest about the mean line
  // 0.75 + 0.1 (x - 1.5): -0.6 1.3 -0.8 0.1: 2.1.
  // Minimum zone: edge from (0, 0) to (2, 0), slope 0, opposite (1, 2): 2; the edge (1, 2) to (3, 1),
  // slope -1/2: rests 0 2.5 1 2.5, 2.5. So 2.
  const Values x{0.0, 1.0, 2.0, 3.0}, e{0.0, 2.0, 0.0, 1.0};
  EXPECT_NEAR(about(StraightLine::end_points, x, e).width, 7.0 / 3.0, 1e-14);
  const Straightness lsq = about(StraightLine::least_squares, x, e);
  EXPECT_NEAR(lsq.width, 2.1, 1e-14);
  EXPECT_NEAR(lsq.b, 0.1, 1e-14);
  EXPECT_NEAR(lsq.a, 0.6, 1e-14);
  const Straightness zone = about(StraightLine::minimum_zone, x, e);
  EXPECT_NEAR(zone.width, 2.0, 1e-14);
  EXPECT_NEAR(zone.b, 0.0, 1e-14);
  EXPECT_NEAR(zone.a, 1.0, 1e-14);
}

TEST(StraightLines, MinimumZoneIsTheSmallestOfAll) {
  std::cout << "seed " << seed << '\n';
  std::mt19937 rng(seed);
  for (int trial = 0; trial < 2000; ++trial) {
    const Line l = random_line(rng);
    const double zone = about(StraightLine::minimum_zone, l.x, l.e).width;
    ASSERT_NEAR(zone, smallest_width(l.x, l.e), 1e-18) << trial;
    for (const StraightLine line : all_lines)
      ASSERT_GE(about(line, l.x, l.e).width, zone - 1e-18) << trial;
  }
}

TEST(StraightLines, SlopeAndHeightOfTheSetUpChangeNothing) {
  std::mt19937 rng(seed + 1);
  for (int trial = 0; trial < 200; ++trial) {
    Line l = random_line(rng), tilted = l;
    for (std::size_t i = 0; i < l.x.size(); ++i) tilted.e[i] += 3e-6 - 40e-6 * l.x[i];
    for (const StraightLine line : all_lines) {
      const Straightness a = about(line, l.x, l.e), b = about(line, tilted.x, tilted.e);
      ASSERT_NEAR(a.width, b.width, 1e-17);
      ASSERT_NEAR(b.b - a.b, -40e-6, 1e-16);
      for (std::size_t i = 0; i < l.x.size(); ++i) ASSERT_NEAR(a.rest[i], b.rest[i], 1e-16);
    }
  }
}

TEST(StraightLines, DerivativesAreThoseOfSmallChanges) {
  std::mt19937 rng(seed + 2);
  for (int trial = 0; trial < 200; ++trial) {
    const Line l = random_line(rng);
    for (const StraightLine line : all_lines) {
      const Straightness s = about(line, l.x, l.e);
      for (std::size_t i = 0; i < l.x.size(); ++i) {
        const double step = 1e-13;
        Values up = l.e, down = l.e;
        up[i] += step, down[i] -= step;
        const Straightness high = about(line, l.x, up), low = about(line, l.x, down);
        ASSERT_NEAR((high.width - low.width) / (2 * step), s.width_by[i], 1e-6)
            << trial << ' ' << i;
        ASSERT_NEAR((high.b - low.b) / (2 * step), s.slope_by[i], 1e-6) << trial << ' ' << i;
      }
    }
  }
}

TEST(StraightLines, RefusesWhatIsNoLine) {
  const Values two{0.0, 1.0}, three{0.0, 1.0, 2.0}, back{0.0, 2.0, 1.0}, same{0.0, 1.0, 1.0},
      bad{0.0, std::numeric_limits<double>::quiet_NaN(), 1.0};
  for (const StraightLine line : all_lines) {
    EXPECT_FALSE(straightness_about(line, two, two));
    EXPECT_FALSE(straightness_about(line, three, two));
    EXPECT_FALSE(straightness_about(line, back, three));
    EXPECT_FALSE(straightness_about(line, same, three));
    EXPECT_FALSE(straightness_about(line, three, bad));
    EXPECT_EQ(about(line, three, {2.0, 2.0, 2.0}).width, 0.0);
  }
}

TEST(StraightLines, AnglesAddUpFootByFoot) {
  // 10, -5, 0 urad on a foot of 0.2 m: 0, 2, 1, 1 um.
  const Values e = integrated(Values{10e-6, -5e-6, 0.0}, 0.2);
  const Values wanted{0.0, 2e-6, 1e-6, 1e-6};
  ASSERT_EQ(e.size(), wanted.size());
  for (std::size_t i = 0; i < e.size(); ++i) EXPECT_NEAR(e[i], wanted[i], 1e-20);
}

}  // namespace
}  // namespace nonio::math
