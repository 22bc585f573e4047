// SPDX-License-Identifier: Apache-2.0
// What is followed over campaigns: values by hand, uncertainties by simulation.
#include "nonio/math/followed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include "axis_builder.h"
#include "nonio/math/iso230_2.h"

namespace nonio::math::followed_test {
namespace {

using made::Noise;
using made::Plan;
using made::Random;

constexpr double um = 1e-6, pi = std::numbers::pi;

std::vector<double> even_targets(std::size_t m, double length) {
  std::vector<double> out;
  for (std::size_t i = 0; i < m; ++i)
    out.push_back(length * static_cast<double>(i) / static_cast<double>(m - 1));
  return out;
}

Campaign stated() {
  Campaign c;
  c.machine.axes.push_back(Axis{.name = "X"});
  c.machine.axes.back().expansion = 11.5e-6;
  c.instrument.U_per_length = 0.6 * um;
  c.environment.misalignment = 1e-3;
  c.environment.temperature_range = 0.2;
  c.environment.temperature_difference = 3.0;
  c.environment.expansion_range = 1.0 * um;
  return c;
}

const Followed& of(const FollowedAxis& all, const std::string& name) {
  static const Followed none{};
  const auto found = std::find_if(all.quantities.begin(), all.quantities.end(),
                                  [&](const Followed& f) { return f.name == name; });
  if (found != all.quantities.end()) return *found;
  ADD_FAILURE() << name << " is not followed";
  return none;
}

bool has(const FollowedAxis& all, const std::string& name) {
  return std::any_of(all.quantities.begin(), all.quantities.end(),
                     [&](const Followed& f) { return f.name == name; });
}

FollowedAxis follow(const Plan& plan, const made::Truth& truth, const Noise& noise, Random& random,
                    const Campaign& campaign = {}) {
  return followed_quantities(AxisTest::arrange(made::observe(plan, truth, noise, random)), campaign,
                             "X", std::nullopt);
}

TEST(Followed, ValuesAreThoseOfTheTruth) {
  Random random(20261123);
  const Plan plan{even_targets(11, 1.0)};
  const auto truth = [](double x, int direction, std::uint32_t) {
    const double z = 2.0 * (x - 0.5);
    return 3 * um + 7 * um * x + 2 * um * (3 * z * z - 1) / 2 -
           1.5 * um * (5 * z * z * z - 3 * z) / 2 - direction * 2.25 * um;
  };
  const FollowedAxis all = follow(plan, truth, {.reading = 1e-9}, random);
  EXPECT_NEAR(of(all, "B_mean").value, -4.5 * um, 2e-9);
  EXPECT_NEAR(of(all, "curve_2").value, 2 * um, 5e-9);
  EXPECT_NEAR(of(all, "curve_3").value, -1.5 * um, 5e-9);
  // P3 has a slope of its own on these targets: sum z P3/sum z^2.
  double zz = 0.0, zp = 0.0;
  for (const double x : plan.targets) {
    const double z = 2.0 * (x - 0.5);
    zz += z * z, zp += z * (5 * z * z * z - 3 * z) / 2;
  }
  EXPECT_NEAR(of(all, "scale").value, 7 * um - 1.5 * um * 2.0 * zp / zz, 5e-9);
  EXPECT_EQ(of(all, "scale").quantity, Quantity::deviation_per_length);
  EXPECT_NEAR(of(all, "ln_s").value, std::log(1e-3), 0.3);
}

TEST(Followed, ASinusoidIsTwoNumbersWhereThePhasesAreSpread) {
  Random random(7);
  Campaign c;
  c.machine.axes.push_back(Axis{.name = "X"});
  c.machine.axes.back().screw_pitch = 0.010;
  const auto truth = [](double x, int, std::uint32_t) {
    return 2 * um * std::cos(2 * pi * x / 0.010) - 3 * um * std::sin(2 * pi * x / 0.010);
  };
  const Plan spread{made::spread_targets(random, 21, 1.0)};
  const FollowedAxis all = follow(spread, truth, {.reading = 1e-9}, random, c);
  EXPECT_NEAR(of(all, "cyclic_cos").value, 2 * um, 5e-9);
  EXPECT_NEAR(of(all, "cyclic_sin").value, -3 * um, 5e-9);
  // Every target at one phase of the screw: a cyclic error is not identifiable.
  const FollowedAxis blind = follow({even_targets(21, 1.0)}, truth, {.reading = 1e-9}, random, c);
  EXPECT_FALSE(has(blind, "cyclic_cos"));
}

TEST(Followed, ARotaryAxisHasItsTurnAndNoScale) {
  Random random(8);
  Plan plan{even_targets(12, 2 * pi * 330 / 360)};
  plan.rotary = true;
  const auto truth = [](double x, int direction, std::uint32_t) {
    return 1e-5 * std::cos(x) + 2e-5 * std::sin(x) + direction * 1e-6;
  };
  const FollowedAxis all = follow(plan, truth, {.reading = 1e-9}, random);
  EXPECT_NEAR(of(all, "turn_cos").value, 1e-5, 5e-9);
  EXPECT_NEAR(of(all, "turn_sin").value, 2e-5, 5e-9);
  EXPECT_NEAR(of(all, "B_mean").value, 2e-6, 5e-9);
  EXPECT_EQ(of(all, "B_mean").quantity, Quantity::angular_deviation);
  EXPECT_FALSE(has(all, "scale"));
}

TEST(Followed, OneRunOrNoScatterIsNotFollowed) {
  Random random(9);
  const auto truth = [](double x, int, std::uint32_t) { return 5 * um * x; };
  EXPECT_TRUE(
      follow({even_targets(11, 1.0), 1}, truth, {.reading = um}, random).quantities.empty());
  EXPECT_TRUE(follow({even_targets(11, 1.0), 5}, truth, {}, random).quantities.empty());
}

TEST(Followed, TheScaleHasWhatTheManifestStates) {
  Random random(10);
  const Plan plan{even_targets(11, 1.0)};
  const auto truth = [](double, int, std::uint32_t) { return 0.0; };
  const AxisTest test = AxisTest::arrange(made::observe(plan, truth, {.reading = 1e-9}, random));
  const double beam = 0.5e-6 / std::sqrt(3.0), sensor = 0.2 * 11.5e-6 / std::sqrt(12.0),
               kelvin = 1e-6 / std::sqrt(12.0);
  const FollowedAxis unread = followed_quantities(test, stated(), "X", std::nullopt),
                     read = followed_quantities(test, stated(), "X", 18.0);
  EXPECT_NEAR(of(unread, "scale").u, std::hypot(beam, sensor, 3.0 * kelvin), 1e-9);
  EXPECT_NEAR(of(read, "scale").u, std::hypot(beam, sensor), 1e-9);
  EXPECT_NEAR(of(read, "scale").of_expansion, -2.0 * kelvin, 1e-15);
  EXPECT_NEAR(of(read, "scale").of_instrument, 0.3e-6, 1e-15);
  EXPECT_EQ(of(read, "B_mean").of_instrument, 0.0);
  EXPECT_TRUE(read.not_stated.empty());
  EXPECT_EQ(followed_quantities(test, {}, "X", std::nullopt).not_stated.size(), 6U);
}

TEST(Followed, AcrossTheAxisTheSlopeIsSetUp) {
  Random random(11);
  const auto truth = [](double x, int, std::uint32_t) { return 5 * um * x * x; };
  const AxisTest test =
      AxisTest::arrange(made::observe({even_targets(11, 1.0)}, truth, {.reading = 1e-9}, random));
  const FollowedAxis all = followed_quantities(test, {}, "X", std::nullopt, Across::yes);
  EXPECT_FALSE(has(all, "scale"));
  EXPECT_NEAR(of(all, "curve_2").value, 5 * um / 6,
              5e-9);  // x^2 = (1 + 2 z + z^2)/4, z^2 = (2 P2 + 1)/3
}

struct Scatter {
  double rms = 0.0, beyond = 0.0;  ///< of (value - truth)/u; share beyond 2
  double mean_u = 0.0;
};

Scatter scatter_of(const std::string& name, double truth, const Noise& noise, unsigned seed) {
  Random random(seed);
  std::cout << name << ": seed " << seed << '\n';
  const Plan plan{made::spread_targets(random, 11, 1.0)};
  const auto exact = [](double x, int direction, std::uint32_t) {
    return 7 * um * x - direction * 2 * um;
  };
  constexpr int trials = 2000;
  Scatter out;
  for (int i = 0; i < trials; ++i) {
    const FollowedAxis all = follow(plan, exact, noise, random);
    const Followed& f = of(all, name);
    const double z = (f.value - truth) / f.u;
    out.rms += z * z / trials;
    out.mean_u += f.u / trials;
    out.beyond += std::fabs(z) > 2.0 ? 1.0 / trials : 0.0;
  }
  out.rms = std::sqrt(out.rms);
  return out;
}

// Five runs: where runs differ, u is known with four degrees of freedom, and the root mean square
// of t is sqrt(4/2) = 1.41 at most.
TEST(Followed, UncertaintiesHoldWhereReadingsAreIndependent) {
  for (const auto& [name, truth] : {std::pair("B_mean", -4 * um), std::pair("scale", 7 * um)}) {
    const Scatter s = scatter_of(name, truth, {.reading = 0.3 * um}, 71);
    EXPECT_GT(s.rms, 0.8) << name;
    EXPECT_LT(s.rms, 1.05) << name;
    EXPECT_LT(s.beyond, 0.06) << name;
  }
}

TEST(Followed, UncertaintiesHoldWhereRunsDiffer) {
  const Scatter B =
      scatter_of("B_mean", -4 * um, {.reading = 0.3 * um, .run = 2 * um, .pass = um}, 72);
  EXPECT_GT(B.rms, 0.9);
  EXPECT_LT(B.rms, 1.5);
  EXPECT_LT(B.beyond, 0.13);
  // What both passes of a run share is no uncertainty of the reversal.
  const Scatter shared = scatter_of("B_mean", -4 * um, {.reading = 0.3 * um, .run = 20 * um}, 73);
  EXPECT_GT(shared.rms, 0.7);
  EXPECT_LT(shared.rms, 1.1);
}

/// Neighbouring readings of a pass are alike.
AxisTest correlated(double r, Random& random) {
  Observations o;
  for (std::uint32_t run = 1; run <= 5; ++run)
    for (const int direction : {1, -1}) {
      double e = made::normal(random);
      for (int i = 0; i < 15; ++i) {
        made::add(o, i / 14.0, direction, 0.3 * um * e, run);
        e = r * e + std::sqrt(1.0 - r * r) * made::normal(random);
      }
    }
  return AxisTest::arrange(o);
}

TEST(Followed, UncertaintiesHoldWhereNeighboursAreAlike) {
  for (const double r : {0.0, 0.4, 0.7})
    for (const char* name : {"B_mean", "curve_2", "curve_3"}) {
      Random random(79);
      double square = 0.0;
      constexpr int trials = 1500;
      for (int i = 0; i < trials; ++i) {
        const FollowedAxis all = followed_quantities(correlated(r, random), {}, "X", std::nullopt);
        const Followed& f = of(all, name);
        square += f.value * f.value / f.u / f.u / trials;
      }
      EXPECT_GT(std::sqrt(square), 0.8) << name << ' ' << r << " seed 79";
      EXPECT_LT(std::sqrt(square), 1.15) << name << ' ' << r << " seed 79";
    }
}

// 2 x 11 targets, 5 runs: u = 1/sqrt(2 * 88) where readings are independent.
TEST(Followed, TheLogarithmOfTheScatterKnowsItsDegreesOfFreedom) {
  const Scatter s = scatter_of("ln_s", std::log(0.3), {.reading = 0.3 * um}, 74);
  EXPECT_NEAR(s.mean_u, 1.0 / std::sqrt(176.0), 0.10 / std::sqrt(176.0));
  EXPECT_GT(s.rms, 0.90);
  EXPECT_LT(s.rms, 1.05);
  const Scatter runs =
      scatter_of("ln_s", std::log(std::hypot(0.3, 1.0)), {.reading = 0.3 * um, .run = um}, 75);
  EXPECT_GT(runs.rms, 0.7);
  EXPECT_LT(runs.rms, 1.6);
}

TEST(Followed, TheLogarithmOfTheScatterKnowsNeighboursThatAreAlike) {
  for (const double r : {0.4, 0.7}) {
    Random random(80);
    double square = 0.0;
    constexpr int trials = 1500;
    for (int i = 0; i < trials; ++i) {
      const FollowedAxis all = followed_quantities(correlated(r, random), {}, "X", std::nullopt);
      const Followed& f = of(all, "ln_s");
      const double d = f.value - std::log(0.3);
      square += d * d / f.u / f.u / trials;
    }
    EXPECT_GT(std::sqrt(square), 0.85) << r << " seed 80";
    EXPECT_LT(std::sqrt(square), 1.2) << r << " seed 80";
  }
}

TEST(Followed, TheCovarianceIsThatOfManyCampaigns) {
  Random random(76);
  const Plan plan{made::spread_targets(random, 7, 1.0)};
  const auto truth = [](double, int, std::uint32_t) { return 0.0; };
  const Noise noise{.reading = 0.5 * um, .run = 0.5 * um};
  constexpr int trials = 4000;
  double printed = 0.0, product = 0.0, sizes = 0.0;
  for (int i = 0; i < trials; ++i) {
    const FollowedAxis all = follow(plan, truth, noise, random);
    const std::size_t n = all.quantities.size();
    ASSERT_EQ(all.covariance.size(), n * n);
    const Followed &a = of(all, "curve_2"), &b = of(all, "curve_3");
    printed += all.covariance[1 * n + 2] / trials;
    product += a.value * b.value / trials;
    sizes += a.u * b.u / trials;
  }
  EXPECT_NEAR(printed / sizes, product / sizes, 0.05);
  EXPECT_GT(std::fabs(printed / sizes), 0.02);
}

// Why a largest value is not followed: it grows with the targets, the scatter does not.
TEST(Followed, RepeatabilityFollowsMoreTargetsAndTheScatterDoesNot) {
  Random random(81);
  const auto truth = [](double, int, std::uint32_t) { return 0.0; };
  double R[2] = {}, ln_s[2] = {};
  constexpr int trials = 600;
  for (const int more : {0, 1})
    for (int i = 0; i < trials; ++i) {
      const AxisTest test = AxisTest::arrange(
          made::observe({even_targets(more ? 21 : 5, 1.0)}, truth, {.reading = um}, random));
      R[more] += evaluate_iso230_2(test, 2.0).R_plus / (4.0 * um) / trials;
      ln_s[more] += of(followed_quantities(test, {}, "X", std::nullopt), "ln_s").value / trials;
    }
  EXPECT_NEAR(R[0], 1.354, 0.03) << "seed 81";
  EXPECT_NEAR(R[1], 1.643, 0.03) << "seed 81";
  EXPECT_NEAR(ln_s[1] - ln_s[0], 0.0, 0.025) << "seed 81";
}

}  // namespace
}  // namespace nonio::math::followed_test
