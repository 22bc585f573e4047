// SPDX-License-Identifier: Apache-2.0
// Fits to the target means and the reversal values: exact for curves that they contain, and their variances by simulation.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "axis_builder.h"
#include "nonio/math/followed.h"

namespace nonio::math::target_fit_test {
namespace {

using made::Noise;
using made::Plan;
using made::Random;

constexpr double um = 1e-6;

std::vector<double> even(std::size_t m, double length) {
  std::vector<double> out;
  for (std::size_t i = 0; i < m; ++i)
    out.push_back(length * static_cast<double>(i) / static_cast<double>(m - 1));
  return out;
}

double legendre(unsigned k, double x, double length) {
  return std::legendre(k, 2.0 * x / length - 1.0);
}

OtherTargets fits(const Plan& plan, const made::Truth& truth, const Noise& noise, Random& random) {
  return followed_quantities(made::arranged(plan, truth, noise, random), {}, "X", std::nullopt)
      .other_targets;
}

double squares(const std::vector<double>& v) {
  return std::inner_product(v.begin(), v.end(), v.begin(), 0.0);
}

// No error of the readings to speak of: without scatter nothing is followed.
const Noise faint{.reading = 1e-6 * um};

TEST(TargetFit, CoefficientsOfACurveThatItContains) {
  Random random(1);
  const Plan plan{even(15, 0.7)};
  const auto truth = [](double x, int direction, std::uint32_t) {
    return (2.0 * legendre(0, x, 0.7) - 3.0 * legendre(1, x, 0.7) + legendre(5, x, 0.7)) * um +
           direction * (1.5 - 0.5 * legendre(2, x, 0.7)) * um;
  };
  const OtherTargets to = fits(plan, truth, faint, random);
  const std::vector<double> mean{2.0, -3.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0},
      reversal{3.0, 0.0, -1.0, 0.0};
  ASSERT_EQ(to.mean.coefficients.size(), mean.size());
  ASSERT_EQ(to.reversal.coefficients.size(), reversal.size());
  for (std::size_t k = 0; k < mean.size(); ++k)
    EXPECT_NEAR(to.mean.coefficients[k] / um, mean[k], 1e-5) << k;
  for (std::size_t k = 0; k < reversal.size(); ++k)
    EXPECT_NEAR(to.reversal.coefficients[k] / um, reversal[k], 1e-5) << k;
  EXPECT_EQ(to.mean.residuals.size(), 15u);
  EXPECT_LT(squares(to.mean.residuals), 1e-8 * um * um);
  EXPECT_DOUBLE_EQ(to.mean.dof, 7.0);
  EXPECT_DOUBLE_EQ(to.reversal.dof, 11.0);
}

TEST(TargetFit, DegreeByTheNumberOfTargets) {
  Random random(1);
  const auto columns = [&](std::size_t m) {
    const OtherTargets to = fits(
        {even(m, 0.7)}, [](double, int, int) { return 0.0; }, faint, random);
    return std::pair(to.mean.coefficients.size(), to.reversal.coefficients.size());
  };
  EXPECT_EQ(columns(4), std::pair(std::size_t{2}, std::size_t{2}));
  EXPECT_EQ(columns(7), std::pair(std::size_t{4}, std::size_t{2}));
  EXPECT_EQ(columns(10), std::pair(std::size_t{5}, std::size_t{2}));
  EXPECT_EQ(columns(11), std::pair(std::size_t{6}, std::size_t{4}));
  EXPECT_EQ(columns(40), std::pair(std::size_t{8}, std::size_t{4}));
}

TEST(TargetFit, ATargetOfOneDirectionHasNoReversalValue) {
  Random random(1);
  Observations o = made::observe(
      {even(9, 0.7)}, [](double, int direction, int) { return direction * um; }, faint, random);
  for (std::uint32_t run = 1; run <= 5; ++run) made::add(o, 0.75, 1, 3.0 * um, run);
  const OtherTargets to =
      followed_quantities(AxisTest::arrange(o), {}, "X", std::nullopt).other_targets;
  EXPECT_EQ(to.mean.residuals.size(), 10u);
  ASSERT_EQ(to.reversal.residuals.size(), 9u);
  EXPECT_NEAR(to.reversal.coefficients[0] / um, 2.0, 1e-5);
  EXPECT_TRUE(
      fits(
          {even(9, 0.7), 5, true, false}, [](double, int, int) { return 0.0; }, faint, random)
          .reversal.coefficients.empty());
}

TEST(TargetFit, VariancesBySimulation) {
  constexpr int repeats = 1500;
  constexpr double between = 0.4 * um;
  Random random(20260301);
  const Plan plan{made::spread_targets(random, 13, 0.6), 4};
  const Noise noise{.reading = 0.6 * um, .run = 0.3 * um, .pass = 0.2 * um};
  double beyond = 0.0, reversal_beyond = 0.0;
  std::vector<double> square(7, 0.0), readings(7, 0.0), share(7, 0.0);
  std::vector<double> residuals(13, 0.0);
  for (int k = 0; k < repeats; ++k) {
    std::vector<double> own;
    for (std::size_t i = 0; i < plan.targets.size(); ++i)
      own.push_back(between * made::normal(random));
    const auto truth = [&](double x, int, std::uint32_t) {
      for (std::size_t i = 0; i < own.size(); ++i)
        if (plan.targets[i] == x) return own[i];
      return 0.0;
    };
    const OtherTargets to = fits(plan, truth, noise, random);
    beyond += to.mean.beyond / repeats, reversal_beyond += to.reversal.beyond / repeats;
    const std::size_t n = to.mean.coefficients.size();
    ASSERT_EQ(n, square.size());
    for (std::size_t i = 0; i < n; ++i) {
      square[i] += to.mean.coefficients[i] * to.mean.coefficients[i] / repeats;
      readings[i] += to.mean.covariance[i * n + i] / repeats;
      share[i] = to.mean.share[i * n + i];
    }
  }
  EXPECT_NEAR(beyond / (between * between), 1.0, 0.06);
  EXPECT_NEAR(reversal_beyond / (between * between), 0.0, 0.06);
  for (std::size_t i = 0; i < square.size(); ++i)
    EXPECT_NEAR(square[i] / (readings[i] + between * between * share[i]), 1.0, 0.15) << i;
}

}  // namespace
}  // namespace nonio::math::target_fit_test
