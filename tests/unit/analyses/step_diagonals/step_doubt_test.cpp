// SPDX-License-Identifier: Apache-2.0
// Check sums and contrasts: set-up, drift and angular errors that readings can show.
#include <iostream>

#include "workshop.h"

namespace steps::step_doubt_test {
namespace {

using namespace nonio::math;

constexpr unsigned seed = 20261123;
constexpr double u = 0.1 * um;

struct Noise {
  std::mt19937 rng{seed};
  std::normal_distribution<double> one{0.0, 1.0};
  StepDiagonals on(StepDiagonals d) {
    for (auto& pass : d.passes)
      for (double& r : pass.reading) r += u * one(rng);
    return d;
  }
};

TEST(StepDoubt, NoiseAloneIsSeldomDoubted) {
  Noise noise;
  std::cout << "seed " << seed << "\n";
  const Volume v{{0.8, 0.6, 0.6}, 20};
  int set_up = 0, trend = 0;
  double mean_u = 0.0;
  const int trials = 1000;
  for (int k = 0; k < trials; ++k) {
    const auto c = check_step_diagonals(noise.on(empty(v)));
    set_up += c.p_constant < 0.01;
    trend += c.p_trend < 0.01;
    mean_u += c.u_reading / trials;
    EXPECT_EQ(c.count, 60U);
  }
  EXPECT_LE(set_up, 20);
  EXPECT_LE(trend, 20);
  EXPECT_NEAR(mean_u, u, 0.02 * u);
}

TEST(StepDoubt, SetUpAngleIsAConstantOfTheChecks) {
  Noise noise;
  const Volume v{{0.8, 0.6, 0.6}, 20};
  std::vector<Optics> set_up(4);
  set_up[1].beam = {0.05e-3, 0.03e-3};
  const auto c = check_step_diagonals(noise.on(measured({}, v, set_up)));
  EXPECT_LT(c.p_constant, 1e-6);
  EXPECT_GT(c.p_trend, 1e-4);
}

TEST(StepDoubt, DriftIsATrendOfTheChecks) {
  Noise noise;
  const Volume v{{0.8, 0.6, 0.6}, 20};
  auto d = empty(v);
  for (std::size_t t = 0; t < 60; ++t)  // warming up in one pass: 20 um, slower and slower
    d.passes[2].reading[t] = 20 * um * (1.0 - std::exp(-static_cast<double>(t) / 30.0));
  EXPECT_LT(check_step_diagonals(noise.on(d)).p_trend, 0.01);
}

TEST(StepDoubt, AnAxisThatAgreesIsSeldomDoubted) {
  Noise noise;
  std::cout << "seed " << seed << "\n";
  const Volume v{{0.8, 0.6, 0.6}, 10};
  int doubted = 0;
  const int trials = 200;
  for (int k = 0; k < trials; ++k) {
    auto axes = lengths({}, v, "X", u);
    for (double& y : axes[0].deviation) y += u * noise.one(noise.rng);
    const auto c = solve_step_diagonals(noise.on(empty(v)), axes, {})->shapes;
    ASSERT_EQ(c.size(), 1U);
    doubted += c[0].p < 0.01;
  }
  EXPECT_LE(doubted, 8);
}

// ECY turns the mirror while Y moves: a false straightness of Y with a false positioning of Y.
TEST(StepDoubt, AngularErrorsThroughTheMirrorContradictTheAxis) {
  Noise noise;
  const Volume v{{0.8, 0.6, 0.6}, 20};
  machine::Errors e;
  e.ECY = [](double y) { return 100 * urad * y / 0.6; };
  const auto d = measured(e, v);
  const auto c =
      solve_step_diagonals(noise.on(d), lengths(e, v, "XYZ", u), {false, true, u})->shapes;
  ASSERT_EQ(c.size(), 3U);
  double least = 1.0;
  for (const auto& axis : c) {
    std::cout << "axis " << axis.axis << ": p " << axis.p << ", rms " << axis.rms / um << " um\n";
    least = std::min(least, axis.p);
  }
  EXPECT_LT(least, 1e-4);
}

}  // namespace
}  // namespace steps::step_doubt_test
