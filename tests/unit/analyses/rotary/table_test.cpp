// SPDX-License-Identifier: Apache-2.0
//
// Monte Carlo: standard deviations against the formulas for equal points on a full circle, those of
// arcs against a table, and how often U covers the truth.
#include "table.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "judge.h"

namespace nonio {
namespace {

using namespace turntable;
using math::fit_rotary;

struct Errors {
  double centre = 0.0, direction = 0.0;  ///< rms of the three coordinates together; rad
  double x = 0.0, y = 0.0, z = 0.0;      ///< of the centre
  double tilt_x = 0.0, tilt_y = 0.0;     ///< of the direction
};

Errors errors_of(const Table& t, const std::vector<double>& angles, double sigma, int trials,
                 unsigned seed) {
  Noise noise(seed);
  const auto exact = t.at(angles);
  Errors e;
  for (int i = 0; i < trials; ++i) {
    const auto fit = fit_rotary(noise.on(exact, sigma), false);
    if (!fit) {
      ADD_FAILURE() << "refused in trial " << i;
      return e;
    }
    const Eigen::Vector3d c(fit->centre[0], fit->centre[1], fit->centre[2]);
    const Eigen::Vector3d d(fit->direction[0], fit->direction[1], fit->direction[2]);
    const Eigen::Vector3d dc = c - t.centre, dd = d - t.direction;
    e.centre += dc.squaredNorm(), e.direction += dd.squaredNorm();
    e.x += dc[0] * dc[0], e.y += dc[1] * dc[1], e.z += dc[2] * dc[2];
    e.tilt_x += dd[0] * dd[0], e.tilt_y += dd[1] * dd[1];
  }
  for (double* v : {&e.centre, &e.direction, &e.x, &e.y, &e.z, &e.tilt_x, &e.tilt_y})
    *v = std::sqrt(*v / trials);
  return e;
}

TEST(RotaryTable, FiveHundredCirclesAsInTheory) {
  const unsigned seed = 1;
  for (const double R : {500 * mm, 50 * mm})
    for (const int n : {3, 4, 5, 10}) {
      Table t;
      t.radius = R;
      t.phase = 0.0;
      const double sigma = 10 * um;
      const Errors e = errors_of(t, full_turn(n), sigma, 500, seed);
      const double centre = sigma * std::sqrt(5.0 / n), tilt = 2.0 * sigma / (R * std::sqrt(n));
      std::printf(
          "seed %u R %3.0f mm N %2d: centre %6.2f um (theory %6.2f), direction %7.2f urad "
          "(%7.2f)\n",
          seed, R / mm, n, e.centre / um, centre / um, e.direction / urad, tilt / urad);
      EXPECT_NEAR(e.centre, centre, 0.07 * centre);
      EXPECT_NEAR(e.direction, tilt, 0.07 * tilt);
      // The covariance says the same without any trial.
      const auto fit = fit_rotary(t.at(full_turn(n)), false);
      EXPECT_NEAR(sigma * std::sqrt(fit->cofactor[0][0]), sigma * std::sqrt(2.0 / n), 1e-10);
      EXPECT_NEAR(sigma * std::sqrt(fit->cofactor[1][1]), sigma * std::sqrt(2.0 / n), 1e-10);
      EXPECT_NEAR(sigma * std::sqrt(fit->cofactor[2][2]), sigma / std::sqrt(n), 1e-10);
      EXPECT_NEAR(sigma * std::sqrt(fit->cofactor[3][3]), sigma * std::sqrt(2.0 / n) / R, 1e-10);
      EXPECT_NEAR(sigma * std::sqrt(fit->cofactor_radius), sigma / std::sqrt(n), 1e-10);
    }
}

/// R = 261 mm, N = 11, sigma 10 um: centre towards the arc, across, along the axis; tilts.
TEST(RotaryTable, ScatterOnArcsIsThatOfTheTable) {
  const struct {
    double span, towards, across, along, tilt_a, tilt_b;
  } rows[] = {{270, 5.0, 3.9, 3.2, 19, 15},  {180, 8.5, 4.1, 5.7, 33, 16},
              {150, 11.5, 4.5, 8.5, 44, 17}, {90, 29, 6.5, 26, 112, 25},
              {60, 64, 9.4, 60, 244, 36},    {30, 250, 18, 247, 960, 70}};
  for (const auto& row : rows) {
    Table t;
    t.direction = {0, 0, 1};
    t.phase = 0.0;
    // The middle of the arc is in the direction of the arm at angle 0.
    const Eigen::Vector3d towards = t.direction.unitOrthogonal();
    const Eigen::Vector3d across = t.direction.cross(towards);
    const auto fit = fit_rotary(t.at(arc(-row.span / 2 * deg, row.span / 2 * deg, 11)), false);
    ASSERT_TRUE(fit);
    Eigen::Matrix<double, 6, 6> q;
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k < 6; ++k)
        q(i, k) = fit->cofactor[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
    const auto sd = [&](const Eigen::Vector3d& v, int first) {
      return 10.0 * std::sqrt(v.dot(q.block<3, 3>(first, first) * v));
    };
    // The table is printed with two digits.
    EXPECT_NEAR(sd(towards, 0), row.towards, 0.02 * row.towards + 0.05) << row.span;
    EXPECT_NEAR(sd(across, 0), row.across, 0.02 * row.across + 0.05) << row.span;
    EXPECT_NEAR(sd(t.direction, 0), row.along, 0.02 * row.along + 0.05) << row.span;
    EXPECT_NEAR(sd(towards, 3), row.tilt_a, 0.02 * row.tilt_a + 0.5) << row.span;
    EXPECT_NEAR(sd(across, 3), row.tilt_b, 0.02 * row.tilt_b + 0.5) << row.span;
  }
}

TEST(RotaryTable, ArcOf150Degrees) {
  const struct {
    int n;
    double towards, tilt;
  } rows[] = {{3, 16.5, 63}, {4, 15.4, 59}, {5, 14.7, 56}, {8, 12.8, 49}, {11, 11.5, 44}};
  const unsigned seed = 2;
  for (const auto& row : rows) {
    Table t;
    t.direction = {0, 0, 1};
    t.phase = 0.0;
    const Eigen::Vector3d towards = t.direction.unitOrthogonal();
    ASSERT_NEAR(std::fabs(towards[0]) + std::fabs(towards[1]), 1.0, 1e-12);  // along an axis
    const auto angles = arc(-75 * deg, 75 * deg, row.n);
    const Errors e = errors_of(t, angles, 10 * um, 2000, seed);
    const bool x = std::fabs(towards[0]) > 0.5;
    std::printf(
        "seed %u arc 150 deg N %2d: towards %5.2f um (theory %5.2f), tilt %5.1f urad (%5.1f)\n",
        seed, row.n, (x ? e.x : e.y) / um, row.towards, (x ? e.tilt_x : e.tilt_y) / urad, row.tilt);
    EXPECT_NEAR((x ? e.x : e.y) / um, row.towards, 0.07 * row.towards);
    EXPECT_NEAR((x ? e.tilt_x : e.tilt_y) / urad, row.tilt, 0.07 * row.tilt);
  }
}

TEST(RotaryTable, TrustedAnglesHalveTheVariance) {
  const Table t;
  const auto plain = fit_rotary(t.at(full_turn(8)), false);
  const auto trusted = fit_rotary(t.at(full_turn(8)), true);
  EXPECT_NEAR(trusted->cofactor[0][0], plain->cofactor[0][0] / 2, 1e-12);
  const auto angles = arc(0, 30 * deg, 11);
  EXPECT_LT(fit_rotary(t.at(angles), true)->cofactor[0][0] * 4,
            fit_rotary(t.at(angles), false)->cofactor[0][0]);
}

/// 2,000 campaigns: C of 8 points, B of 11 on an arc, 5 points, 3 points with a stated sigma; with
/// and without the encoder's angles.
TEST(RotaryTable, UCoversTheTruth) {
  const unsigned seed = 20260402;
  const struct {
    const char* name;
    std::vector<double> angles;
    bool stated, use_angles;
  } kinds[] = {{"8 points", full_turn(8), false, false},
               {"8 points, stated sigma", full_turn(8), true, false},
               {"8 points, angles", full_turn(8), false, true},
               {"11 points on 150 deg", arc(-60 * deg, 90 * deg, 11), false, false},
               {"11 points on 150 deg, angles", arc(-60 * deg, 90 * deg, 11), false, true},
               {"4 points", full_turn(4), false, false},
               {"3 points, stated sigma", full_turn(3), true, false}};
  for (const auto& kind : kinds) {
    Noise noise(seed);
    constexpr int campaigns = 2000;
    int covered[7] = {};
    for (int i = 0; i < campaigns; ++i) {
      Table t;
      t.direction = Eigen::Vector3d(noise.uniform(-1, 1), noise.uniform(-1, 1), 1).normalized();
      t.phase = noise.uniform(-3, 3);
      const double sigma = noise.uniform(0.5, 5.0) * um;
      rotary_kinematics::Wish wish;
      wish.use_angles = kind.use_angles;
      wish.tolerance = wish.tolerance_direction = 1.0;
      wish.linear_axes = 0.0;
      if (kind.stated) wish.sigma = sigma;
      const auto j = rotary_kinematics::judge(observed(noise.on(t.at(kind.angles), sigma)), wish);
      ASSERT_TRUE(j.given) << kind.name << ": " << j.findings.front().id;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto c = static_cast<int>(k);
        covered[k] += std::fabs(j.fit.centre[k] - t.centre[c]) <= j.k * j.u_centre(k);
        covered[3 + k] += std::fabs(j.fit.direction[k] - t.direction[c]) <= j.k * j.u_direction(k);
      }
      covered[6] += std::fabs(j.fit.radius - t.radius) <= j.k * j.u_radius();
    }
    std::printf("seed %u %-28s centre %.2f %.2f %.2f direction %.2f %.2f %.2f radius %.2f %%\n",
                seed, kind.name, covered[0] / 20.0, covered[1] / 20.0, covered[2] / 20.0,
                covered[3] / 20.0, covered[4] / 20.0, covered[5] / 20.0, covered[6] / 20.0);
    for (const int n : covered) {
      EXPECT_GE(n, campaigns * 93 / 100) << kind.name;
      EXPECT_LE(n, campaigns * 97 / 100) << kind.name;
    }
  }
}

}  // namespace
}  // namespace nonio
