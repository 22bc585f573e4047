// SPDX-License-Identifier: Apache-2.0
// What another choice of targets adds to a comparison: by residuals whose parts are known.
#include "laboratory/assessment/targets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace nonio::assessment::targets_test {
namespace {

namespace kernel = nonio::statistics;

constexpr std::size_t targets = 14;
constexpr double dof = 10.0, u_readings = 0.05;

// A visit whose residuals are a wave that all visits have and a part that its targets draw anew.
PointTargets visit(std::size_t k, double wave, double anew, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  PointTargets out{.digest = std::to_string(k), .span = {0.0, 500.0}, .fit = {}};
  out.fit.curve = {
      out.span, {0.0, 0.0, 0.0, 0.0}, std::vector<double>(16, 0.0), std::vector<double>(16, 0.0)};
  for (std::size_t i = 0; i < 16; i += 5)
    out.fit.curve.covariance[i] = u_readings * u_readings, out.fit.curve.share[i] = 0.25;
  double sum = 0.0;
  for (std::size_t i = 0; i < targets; ++i) {
    const double x = static_cast<double>(i);
    out.fit.residuals.push_back(
        std::sqrt(dof / targets) *
        (wave * std::numbers::sqrt2 * std::cos(2.1 * x) + anew * normal(random)));
    sum += out.fit.residuals.back() * out.fit.residuals.back();
  }
  out.fit.dof = dof, out.fit.beyond = sum / dof;  // readings without scatter
  return out;
}

std::vector<PointTargets> visits(std::size_t count, double wave, double anew, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<PointTargets> out;
  for (std::size_t k = 0; k < count; ++k) out.push_back(visit(k, wave, anew, random));
  return out;
}

std::vector<kernel::Point> points(std::size_t count) {
  std::vector<kernel::Point> out(count);
  for (std::size_t k = 0; k < count; ++k)
    out[k].time = static_cast<double>(k), out[k].u = u_readings;
  return out;
}

// Standard uncertainty of the difference of two points that the choice of targets makes.
double of_targets(const std::vector<PointTargets>& all, std::size_t a, std::size_t b) {
  const Compared c = compared(points(all.size()), all, "curve_2");
  double square = 0.0;
  const auto has = [](const kernel::Point& p, const std::string& source) {
    for (const kernel::Common& part : p.common)
      if (part.source == source) return true;
    return false;
  };
  for (const auto& [p, q] : {std::pair(a, b), std::pair(b, a)})
    for (const kernel::Common& part : c.points[p].common)
      if (!has(c.points[q], part.source)) square += part.u * part.u;
  return std::sqrt(square);
}

TEST(Targets, WhatAllVisitsSeeCancels) {
  EXPECT_NEAR(of_targets(visits(8, 1.0, 0.0, 1), 3, 4), 0.0, 1e-9);
  const Compared c = compared(points(8), visits(8, 1.0, 0.0, 1), "curve_2");
  ASSERT_EQ(c.points[0].common.size(), 1u);  // and counts against other kinds of fits
  EXPECT_NEAR(c.points[0].common[0].u, 0.5, 0.05);
  EXPECT_TRUE(is_targets(c.points[0].common[0].source));
}

TEST(Targets, WhatEachDrawsAnewCounts) {
  double mean = 0.0;
  constexpr int repeats = 200;
  for (unsigned seed = 1; seed <= repeats; ++seed)
    mean += std::pow(of_targets(visits(8, 1.0, 0.3, seed), 3, 4), 2) / repeats;
  // Twice 0.25 x 0.3^2, and larger for its few degrees of freedom: 45 make it 1.15 times as large.
  EXPECT_NEAR(std::sqrt(mean), std::sqrt(2.0 * 0.25 * 1.15) * 0.3, 0.01);
}

TEST(Targets, AChangeOfTheMachineIsInOneDifference) {
  std::vector<PointTargets> all = visits(8, 0.0, 0.1, 3), stepped = all;
  for (std::size_t k = 5; k < 8; ++k) {
    for (std::size_t i = 0; i < targets; ++i)
      stepped[k].fit.residuals[i] += i % 2 == 0 ? 3.0 : -3.0;
    double sum = 0.0;
    for (const double r : stepped[k].fit.residuals) sum += r * r;
    stepped[k].fit.beyond = sum / dof;
  }
  EXPECT_NEAR(of_targets(stepped, 1, 2), of_targets(stepped, 6, 7), 0.04);
  EXPECT_LT(of_targets(stepped, 1, 2), 0.15);
  EXPECT_GT(of_targets(stepped, 4, 5), 0.5);  // its neighbors do not know whose it is
}

TEST(Targets, AVisitUnlikeTheOthersIsLessCertain) {
  std::vector<PointTargets> all = visits(8, 0.0, 0.1, 4);
  std::mt19937_64 random(5);
  all[3] = visit(3, 0.0, 2.0, random);
  EXPECT_GT(of_targets(all, 3, 6), 3.0 * of_targets(all, 0, 6));
}

TEST(Targets, OfFewVisitsOrOtherKindsAllCounts) {
  EXPECT_NEAR(of_targets(visits(3, 1.0, 0.0, 1), 0, 1), std::sqrt(2.0 * 0.25), 0.05);
  std::vector<PointTargets> all = visits(8, 1.0, 0.0, 1);
  for (std::size_t k = 4; k < 8; ++k) all[k].fit.dof -= 2.0;  // sinusoids in addition to the curve
  EXPECT_GT(of_targets(all, 3, 4), 0.6);
  EXPECT_NEAR(of_targets(all, 4, 5), 0.0, 1e-9);
  for (PointTargets& t : all) t.fit.residuals.clear();  // of an older version
  EXPECT_GT(of_targets(all, 4, 5), 0.6);
}

TEST(Targets, OfTheSameTargetsNothingIsConverted) {
  std::vector<PointTargets> all = visits(5, 1.0, 0.3, 1);
  for (PointTargets& t : all) t.digest = "same";
  const Compared c = compared(points(5), all, "curve_2");
  EXPECT_FALSE(c.over);
  EXPECT_TRUE(c.points[0].common.empty());
}

}  // namespace
}  // namespace nonio::assessment::targets_test
