// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "table.h"

namespace nonio {
namespace {

using namespace turntable;
using math::fit_rotary;
using math::RotaryRefusal;

Table anywhere(Noise& noise) {
  Table t;
  const auto random = [&](double size) {
    return Eigen::Vector3d(noise.uniform(-size, size), noise.uniform(-size, size),
                           noise.uniform(-size, size));
  };
  t.centre = random(3.0);
  t.direction = random(1.0);
  while (t.direction.norm() < 0.1) t.direction = random(1.0);
  t.direction.normalize();
  t.radius = noise.uniform(0.02, 0.8);
  t.phase = noise.uniform(-3.0, 3.0);
  return t;
}

TEST(RotaryFit, WithoutNoiseTheAxisComesBack) {
  const unsigned seed = 20260401;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Noise noise(seed);
  for (int i = 0; i < 200; ++i) {
    const Table t = anywhere(noise);
    const auto angles = i % 2 == 0 ? full_turn(3 + i % 10)
                                   : arc(-60 * deg, noise.uniform(-25.0, 200.0) * deg, 3 + i % 12);
    for (const bool use_angles : {false, true}) {
      const auto fit = fit_rotary(t.at(angles), use_angles);
      ASSERT_TRUE(fit) << i;
      EXPECT_LT(distance(fit->centre, t.centre), 0.05 * um) << i;
      EXPECT_LT(std::fabs(fit->radius - t.radius), 0.05 * um) << i;
      EXPECT_LT(distance(fit->direction, t.direction) * t.radius, 0.05 * um) << i;
      EXPECT_LT(fit->s, 0.01 * um) << i;
    }
  }
}

TEST(RotaryFit, DirectionIsRightHandedWithTheAngles) {
  Table t;
  t.direction = Eigen::Vector3d(0.2, -0.9, 0.1).normalized();
  auto centres = t.at(full_turn(7));
  EXPECT_LT(distance(fit_rotary(centres, false)->direction, t.direction), 1e-9);
  for (auto& c : centres) c.angle = -c.angle;
  EXPECT_LT(distance(fit_rotary(centres, false)->direction, -t.direction), 1e-9);
  EXPECT_LT(distance(fit_rotary(centres, true)->direction, -t.direction), 1e-9);
}

/// Two directions that a source prints for balls 261 mm from the axis; B of 11 points on 150 deg, C of
/// 8 on a full turn. What it makes of the first, 1.4627e-4 rad and 0.0382 mm, follows from it.
TEST(RotaryFit, DirectionsThatASourcePrints) {
  const auto text = [](const char* format, double value) {
    char out[32];
    std::snprintf(out, sizeof out, format, value);
    return std::string(out);
  };
  Table b, c;
  b.radius = c.radius = 261 * mm;
  b.direction = Eigen::Vector3d(1.2540e-04, 1, -7.5293e-05).normalized();
  c.direction = Eigen::Vector3d(0.000054, 0.00007, 1).normalized();
  const auto along_b = fit_rotary(b.at(arc(-60 * deg, 90 * deg, 11)), true);
  const auto along_c = fit_rotary(c.at(full_turn(8)), true);
  ASSERT_TRUE(along_b && along_c);
  const auto& d = along_b->direction;
  const auto& e = along_c->direction;
  EXPECT_EQ(text("%.4e", d[0] / d[1]), "1.2540e-04");
  EXPECT_EQ(text("%.4e", d[2] / d[1]), "-7.5293e-05");
  const double tilt = std::hypot(d[0] / d[1], d[2] / d[1]);
  EXPECT_EQ(text("%.4e", tilt), "1.4627e-04");
  EXPECT_EQ(text("%.4f", tilt * 261), "0.0382");
  EXPECT_EQ(text("%.6f", e[0] / e[2]), "0.000054");
  EXPECT_EQ(text("%.5f", e[1] / e[2]), "0.00007");
}

TEST(RotaryFit, ResidualsHaveTheirSigns) {
  Table t;
  auto centres = t.at(full_turn(12));
  const double grow = (t.radius + 5 * um) / t.radius;
  for (std::size_t k = 0; k < 3; ++k)
    centres[3].at[k] =
        t.centre[static_cast<int>(k)] + grow * (centres[3].at[k] - t.centre[static_cast<int>(k)]);
  centres[7].at[2] += 4 * um;
  const auto fit = fit_rotary(centres, false);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->radial[3], 5 * um * (1 - 3.0 / 12), 0.05 * um);  // 3 parameters of 12 points
  EXPECT_NEAR(fit->axial[7], 4 * um * (1 - 3.0 / 12), 0.05 * um);
  for (auto& c : centres) c.angle = -c.angle;
  EXPECT_NEAR(fit_rotary(centres, false)->axial[7], -3 * um, 0.05 * um);
}

TEST(RotaryFit, ABallAheadOfItsAngleHasAPositiveTangentialResidual) {
  const Table t;
  auto centres = t.at(full_turn(12));
  centres[5].at = t.at(centres[5].angle + 3 * um / t.radius).at;
  EXPECT_NEAR(fit_rotary(centres, false)->tangential[5], 3 * um * (1 - 1.0 / 12), 0.05 * um);
  for (auto& c : centres) c.angle = -c.angle;  // the encoder counts the other way
  EXPECT_NEAR(fit_rotary(centres, false)->tangential[5], -3 * um * (1 - 1.0 / 12), 0.05 * um);
}

TEST(RotaryFit, WeightsAreReadings) {
  const Table t;
  auto centres = t.at(full_turn(6));
  Noise noise(5);
  centres = noise.on(centres, 10 * um);
  auto twice = centres;
  for (auto& c : twice) c.weight = 4.0;
  const auto one = fit_rotary(centres, false), four = fit_rotary(twice, false);
  EXPECT_LT(
      distance(one->centre, Eigen::Vector3d(four->centre[0], four->centre[1], four->centre[2])),
      1e-12);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(four->cofactor[i][i], one->cofactor[i][i] / 4.0, 1e-12);
  // A centre of next to no weight is as if it were not there.
  auto seven = t.at(full_turn(7));
  auto without = seven;
  without.erase(without.begin() + 2);
  seven[2].at[0] += 1 * mm;
  seven[2].weight = 1e-9;
  const auto light = fit_rotary(seven, false), absent = fit_rotary(without, false);
  EXPECT_LT(distance(light->centre, t.centre), 0.001 * um);
  EXPECT_NEAR(light->cofactor[0][0], absent->cofactor[0][0], 1e-6);
}

TEST(RotaryFit, ShearOfTheLinearAxes) {  // D.4: exact, with a sheared machine
  const auto shift = [](double radius, const std::vector<double>& angles, double shear, double at) {
    Table t;
    t.radius = radius;
    t.centre.setZero();
    t.phase = at;
    t.linear_axes(0, 1) = shear;
    const auto fit = fit_rotary(t.at(angles), false);
    EXPECT_TRUE(fit);
    return std::hypot(fit->centre[0], fit->centre[1]);
  };
  EXPECT_NEAR(shift(0.5, full_turn(3), 40 * urad, 0.7), 10.000 * um, 0.002 * um);
  for (const int n : {4, 5, 8, 11})
    EXPECT_LT(shift(0.5, full_turn(n), 40 * urad, 0.7), 0.002 * um) << n;
  // Arcs of 11 points: the least and the largest shift over all directions of the shear.
  const struct {
    double span, least, most;
  } expected[] = {{180, 3.6, 10.4}, {150, 5.2, 13.1}, {90, 8.3, 17.8}};
  for (const auto& e : expected) {
    double least = 1.0, most = 0.0;
    for (int a = 0; a < 90; ++a) {
      const double s = shift(0.261, arc(0, e.span * deg, 11), 40 * urad, a * 2 * deg);
      least = std::min(least, s), most = std::max(most, s);
    }
    Table t;
    const auto fit = fit_rotary(t.at(arc(0, e.span * deg, 11)), false);
    EXPECT_NEAR(fit->shear_shift * 40 * urad, most, 0.01 * most) << e.span;
    EXPECT_NEAR(least / um, e.least, 0.1) << e.span;
    EXPECT_NEAR(most / um, e.most, 0.1) << e.span;
  }
}

TEST(RotaryFit, ShearShiftWithAngles) {
  Table t;
  t.centre.setZero();
  const auto angles = arc(-60 * deg, 90 * deg, 11);
  double most = 0.0;
  for (int a = 0; a < 90; ++a) {
    Table sheared = t;
    sheared.phase = a * 2 * deg;
    sheared.linear_axes(0, 1) = sheared.linear_axes(1, 0) = 20 * urad;
    const auto fit = fit_rotary(sheared.at(angles), true);
    most = std::max(most, std::hypot(fit->centre[0], fit->centre[1]));
  }
  EXPECT_NEAR(fit_rotary(t.at(angles), true)->shear_shift * 40 * urad, most, 0.01 * most);
}

TEST(RotaryFit, SquarenessOfTheThirdAxisTiltsTheDirection) {
  Table t;
  t.centre.setZero();
  t.direction = {0, 1, 0};
  t.linear_axes(2, 1) = 30 * urad;  // moving Y lifts: n' ~ M^-T n
  t.direction.normalize();
  const auto fit = fit_rotary(t.at(full_turn(8)), false);
  const Eigen::Vector3d expected = t.linear_axes.inverse().transpose() * t.direction;
  EXPECT_LT(distance(fit->direction, expected.normalized()), 0.01 * urad);
}

TEST(RotaryFit, TheFactorOfExpansionIsThatOfTheTDistribution) {
  // GUM, table G.2, p = 95.45 %
  for (const auto& [dof, k] : {std::pair(1, 13.97), {2, 4.53}, {3, 3.31}, {10, 2.28}, {50, 2.05}})
    EXPECT_NEAR(math::expansion_factor(dof), k, 0.005) << dof;
}

TEST(RotaryFit, DoubleWaveIsTheEllipse) {
  Table t;
  t.radius = 0.5;
  t.linear_axes(0, 1) = 40 * urad;
  Noise noise(3);
  const auto centres = noise.on(t.at(full_turn(8)), 0.2 * um);
  const auto fit = fit_rotary(centres, false);
  const auto wave = math::double_wave(*fit, centres, fit->radial);
  EXPECT_NEAR(wave.amplitude, 0.5 * 40 * urad / 2, 0.4 * um);
  EXPECT_LT(wave.p, 1e-4);
  EXPECT_LT(wave.left, 0.5 * um);
  for (std::size_t i = 0; i < centres.size(); ++i)
    EXPECT_NEAR(fit->radial[i], wave.amplitude * std::cos(2 * (fit->around[i] - wave.phase)),
                1.0 * um);
  EXPECT_GT(math::double_wave(*fit, centres, fit->axial).p, 0.01);
  // Angles that are not even: the long axis of the ellipse is no axis of the points.
  std::vector<double> angles;
  for (const double a : {0, 15, 30, 45, 60, 75, 120, 180, 240, 300}) angles.push_back(a * deg);
  const auto uneven = t.at(angles);
  const auto turned = fit_rotary(uneven, false);
  const auto its = math::double_wave(*turned, uneven, turned->radial);
  EXPECT_GT(std::fabs(its.phase), 5 * deg);
  double product = 0.0, square = 0.0;
  for (std::size_t i = 0; i < uneven.size(); ++i) {
    const double wave_here = std::cos(2 * (turned->around[i] - its.phase));
    product += turned->radial[i] * wave_here;
    square += wave_here * wave_here;
  }
  EXPECT_NEAR(product / square, its.amplitude, 0.4 * its.amplitude);
  // On an arc an ellipse is not separable from a shift.
  const auto part = t.at(arc(0, 150 * deg, 11));
  EXPECT_EQ(math::double_wave(*fit_rotary(part, false), part, fit->radial).p, 1.0);
}

TEST(RotaryFit, RefusesByName) {
  const Table t;
  const auto refusal = [](std::vector<math::BallCentre> c) {
    const auto fit = fit_rotary(c, false);
    EXPECT_FALSE(fit);
    return fit ? RotaryRefusal::weight : fit.error();
  };
  const auto good = t.at(full_turn(6));
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e300, 1e7}) {
    for (std::size_t k = 0; k < 3; ++k) {
      auto c = good;
      c[2].at[k] = bad;
      EXPECT_EQ(refusal(c), RotaryRefusal::not_finite) << bad;
    }
  }
  for (const double bad : {nan, inf}) {
    auto c = good;
    c[4].angle = bad;
    EXPECT_EQ(refusal(c), RotaryRefusal::not_finite);
  }
  for (const double bad : {0.0, -1.0, nan, inf}) {
    auto c = good;
    c[1].weight = bad;
    auto fit = fit_rotary(c, false);
    ASSERT_FALSE(fit);
    EXPECT_EQ(fit.error(), RotaryRefusal::weight);
  }
  EXPECT_EQ(refusal({}), RotaryRefusal::too_few);
  EXPECT_EQ(refusal({good[0], good[1]}), RotaryRefusal::too_few);
  EXPECT_EQ(refusal(t.at({0, 1, 2, 1})), RotaryRefusal::repeated_angles);
  EXPECT_EQ(refusal(t.at({0, 1, 2, 1 + 360 * deg})), RotaryRefusal::repeated_angles);
  EXPECT_EQ(refusal(t.at({0, 1, 2, 360 * deg - 1e-9})), RotaryRefusal::repeated_angles);
  auto same = good;
  for (auto& c : same) c.at = good[0].at;
  EXPECT_EQ(refusal(same), RotaryRefusal::collinear);
  auto line = good;
  for (std::size_t i = 0; i < line.size(); ++i)
    line[i].at = {0.1 * static_cast<double>(i), 0.2 * static_cast<double>(i), 0.3};
  EXPECT_EQ(refusal(line), RotaryRefusal::collinear);
  auto shuffled = good;
  std::swap(shuffled[1].at, shuffled[4].at);
  EXPECT_EQ(refusal(shuffled), RotaryRefusal::angles_disagree);
}

/// A cluster of noise is no circle: whatever the reason, it is refused.
TEST(RotaryFit, NoiseInOnePlaceIsRefused) {
  const unsigned seed = 77;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Noise noise(seed);
  Table t;
  t.radius = 0.0;
  int taken = 0;
  for (int i = 0; i < 200; ++i)
    taken += fit_rotary(noise.on(t.at(full_turn(8)), 5 * um), false) ? 1 : 0;
  EXPECT_EQ(taken, 0);
}

TEST(RotaryFit, RelationOfTwoLines) {
  Table a, b;
  a.centre = {0.1, 0.2, 0.3};
  a.direction = Eigen::Vector3d(0.1, 0.02, 1).normalized();
  b.centre = {0.15, -0.1, 0.2};
  b.direction = Eigen::Vector3d(0.03, 1, -0.05).normalized();
  const double angle = std::acos(a.direction.dot(b.direction));
  const Eigen::Vector3d normal = a.direction.cross(b.direction).normalized();
  const double apart = std::fabs((b.centre - a.centre).dot(normal));
  const auto ca = a.at(full_turn(8)), cb = b.at(arc(-60 * deg, 90 * deg, 11));
  const auto r = relation_of(*fit_rotary(ca, false), 0.0, *fit_rotary(cb, false), 0.0);
  EXPECT_NEAR(r.distance, apart, 0.01 * um);
  EXPECT_NEAR(r.angle, angle, 1e-8);
  // Its uncertainty against repeated measurements.
  const unsigned seed = 11;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Noise noise(seed);
  double distance2 = 0.0, angle2 = 0.0;
  constexpr int trials = 2000;
  for (int i = 0; i < trials; ++i) {
    const auto one = relation_of(*fit_rotary(noise.on(ca, 5 * um), false), 5 * um,
                                 *fit_rotary(noise.on(cb, 5 * um), false), 5 * um);
    distance2 += std::pow((one.distance - apart) / one.u_distance, 2);
    angle2 += std::pow((one.angle - angle) / one.u_angle, 2);
  }
  EXPECT_NEAR(std::sqrt(distance2 / trials), 1.0, 0.06);
  EXPECT_NEAR(std::sqrt(angle2 / trials), 1.0, 0.06);
}

TEST(RotaryFit, ParallelLines) {
  Table a, b;
  b.centre = a.centre + Eigen::Vector3d(0.03, 0.04, 0.5);
  const auto r = relation_of(*fit_rotary(a.at(full_turn(8)), false), 1 * um,
                             *fit_rotary(b.at(full_turn(8)), false), 1 * um);
  EXPECT_NEAR(r.distance, 0.05, 0.01 * um);
  EXPECT_LT(r.angle, 1e-7);
  EXPECT_GT(r.u_distance, 0.0);
  EXPECT_GT(r.u_angle, 0.0);
}

}  // namespace
}  // namespace nonio
