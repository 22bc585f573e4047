// SPDX-License-Identifier: Apache-2.0
// What noise does: gains of the reference, and uncertainties that cover the truth.
#include <iostream>

#include "workshop.h"

namespace steps {
namespace {

using namespace nonio::math;

constexpr unsigned seed = 20261122;

const StepCurve& curve(const StepSolution& s, const std::string& name) {
  for (const auto& c : s.curves)
    if (c.name == name) return c;
  throw std::runtime_error(name);
}

TEST(StepNoise, AveragingIsARandomWalk) {
  const Volume v;
  const auto s = average_step_diagonals(empty(v), {true, true, 1.0 * um});
  ASSERT_TRUE(s);
  const auto& c = curve(*s, "EXX");
  const double alpha = 0.8 / std::sqrt(0.8 * 0.8 + 2 * 0.6 * 0.6);
  for (std::size_t i = 0; i <= v.n; ++i)
    EXPECT_NEAR(c.u[i], std::sqrt(2.0 * static_cast<double>(i)) * um / (2.0 * alpha), 1e-3 * um);
  EXPECT_NEAR(c.u.back(), 6.5 * um, 0.05 * um);
}

TEST(StepNoise, GainsOfTheFitWithThreeAxes) {
  struct Case {
    std::size_t n;
    double EXX, EYX, EZX, EXY;
  };
  for (const Case& c : {Case{10, .67, 1.8, 1.9, 1.5}, Case{40, .67, 3.7, 3.8, 2.9}}) {
    const Volume v{{0.8, 0.6, 0.6}, c.n};
    const auto s =
        solve_step_diagonals(empty(v), lengths({}, v, "XYZ", 1.0 * um), {false, true, 1.0 * um});
    ASSERT_TRUE(s);
    const auto mid = [&](const char* name) { return curve(*s, name).u[c.n / 2] / um; };
    std::cout << "n " << c.n << ": EXX " << mid("EXX") << " EYX " << mid("EYX") << " EZX "
              << mid("EZX") << " EXY " << mid("EXY") << "; squareness Y "
              << s->squareness[0].u * 0.6 / um << " " << s->squareness[1].u * 0.6 / um << " "
              << s->squareness[2].u * 0.6 / um << "\n";
  }
}

/// Adds white noise to every reading, that of the start included.
void shake(StepDiagonals& d, std::mt19937& rng, double u) {
  std::normal_distribution<double> noise(0.0, u);
  for (auto& pass : d.passes) {
    const double start = noise(rng);
    for (double& r : pass.reading) r += noise(rng) - start;
  }
}

TEST(StepNoise, UncertaintyCoversTheTruth) {
  std::mt19937 rng(seed);
  std::cout << "seed " << seed << "\n";
  const Volume v{{0.8, 0.6, 0.5}, 7};
  const double u = 0.5 * um, u_axis = 0.3 * um;
  std::normal_distribution<double> noise(0.0, u_axis);
  int held[2] = {0, 0}, all[2] = {0, 0};
  for (int k = 0; k < 2000; ++k) {
    const auto e = random_errors(rng, v, 20 * um);
    auto d = measured(e, v, random_set_up(rng, 0.2e-3, true));
    shake(d, rng, u);
    auto axes = lengths(e, v, "XYZ", u_axis);
    for (auto& s : axes)
      for (double& y : s.deviation) y += noise(rng);
    const bool told = k % 2 == 0;  // else from the residuals
    const auto s = solve_step_diagonals(d, axes, {false, true, told ? u : 0.0});
    ASSERT_TRUE(s);
    const auto count = [&](double value, double truth, double one_sigma) {
      ++all[told];
      held[told] += std::fabs(value - truth) <= 2.0 * one_sigma;
    };
    for (const auto& c : s->curves) {
      const auto wanted = truth(e, v, c);
      for (std::size_t i = 1; i < wanted.size(); ++i) count(c.value[i], wanted[i], c.u[i]);
    }
    const auto square = true_squareness(e, v);
    for (std::size_t i = 0; i < 3; ++i)
      count(s->squareness[i].value, square[i], s->squareness[i].u);
  }
  for (const int told : {0, 1}) {
    const double share = static_cast<double>(held[told]) / all[told];
    std::cout << (told ? "u told: " : "u from residuals: ") << 100 * share << " % of " << all[told]
              << "\n";
    EXPECT_GT(share, 0.93);
    EXPECT_LT(share, 0.97);
  }
}

}  // namespace
}  // namespace steps
