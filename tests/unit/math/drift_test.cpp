// SPDX-License-Identifier: Apache-2.0
//
// Drift that goes on while the axis is measured: + upwards, then - downwards, run after run. How often
// it is found, how often a stationary axis is accused, and whether U covers the reversal.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>

#include "nonio/math/axis_findings.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/uncertainty.h"

namespace nonio::math::drift_test {
namespace {

constexpr double um = 1e-6, travel = 0.79, true_B = -2.0 * um;

struct Made {
  std::size_t targets = 9;
  std::uint32_t runs = 2;
  double parallel = 0.0, wedge = 0.0;  ///< over the whole test, m; wedge: at the far end
  double reading = 0.3 * um;           ///< scatter
  double run = 0.0;                    ///< offset that each run has for itself
  double elastic = 0.0;                ///< reversal that varies along the axis
  bool minus_first = false;
};

class DriftingAxis {
 public:
  explicit DriftingAxis(std::uint32_t seed) : random_(seed) {}

  AxisTest measure(const Made& made) {
    Observations o;
    o.axes.push_back({"X", false, {}, {}});
    const auto m = made.targets;
    std::vector<double> targets;
    std::uniform_real_distribution<double> uneven(-0.25, 0.25);
    for (std::size_t i = 0; i < m; ++i)
      targets.push_back((static_cast<double>(i) + uneven(random_)) * travel /
                        static_cast<double>(m - 1));
    const double all = static_cast<double>(2 * m * made.runs);
    double taken = 0.0;
    for (std::uint32_t run = 1; run <= made.runs; ++run) {
      const double of_run = made.run * normal();
      for (const int d : made.minus_first ? std::vector{-1, 1} : std::vector{1, -1})
        for (std::size_t k = 0; k < m; ++k) {
          const double x = targets[d > 0 ? k : m - 1 - k], share = x / travel;
          const double error = 10.0 * um * share + 3.0 * um * std::sin(4.0 * share);
          const double B = true_B + made.elastic * std::cos(3.0 * share);
          o.axes[0].position.push_back(x);
          o.axes[0].approach.push_back(static_cast<std::int8_t>(d));
          o.run.push_back(run);
          o.deviation.push_back(error + d * B / 2.0 + of_run + made.reading * normal() +
                                (made.parallel + made.wedge * share) * taken / all);
          taken += 1.0;
        }
    }
    return AxisTest::arrange(o);
  }

 private:
  double normal() { return std::normal_distribution<double>()(random_); }
  std::mt19937 random_;
};

bool drift_found(const AxisTest& test, bool with_attention = false) {
  std::vector<Finding> findings;
  drift_findings(test, findings);
  for (const Finding& f : findings)
    if (!with_attention || f.attention) return true;
  return false;
}

int found(DriftingAxis& axis, const Made& made, int campaigns, bool with_attention = false) {
  int count = 0;
  for (int n = 0; n < campaigns; ++n) count += drift_found(axis.measure(made), with_attention);
  return count;
}

// Two runs are the fewest that a test of an axis has.
TEST(Drift, IsFoundFromTwoRunsOnAndNoTableIsMadeOfIt) {
  constexpr std::uint32_t seed = 4711;
  DriftingAxis axis(seed);
  constexpr int campaigns = 400;
  for (const std::uint32_t runs : {2U, 3U, 4U, 5U})
    for (const std::size_t targets : {5U, 9U, 21U})
      for (const bool wedge : {false, true}) {
        const Made made{.targets = targets,
                        .runs = runs,
                        .parallel = wedge ? 0.0 : 10.0 * um,
                        .wedge = wedge ? 10.0 * um : 0.0};
        const int count = found(axis, made, campaigns, true);
        std::cout << runs << " runs, " << targets << " targets, " << (wedge ? "wedge" : "parallel")
                  << ": found " << count << " of " << campaigns << "\n";
        EXPECT_GE(count, campaigns * (runs == 2 ? 98 : 99) / 100) << "seed " << seed;
      }
  EXPECT_GE(found(axis, {.parallel = -10.0 * um, .minus_first = true}, 100), 98);
}

TEST(Drift, IsNotSeenInStationaryTests) {
  constexpr std::uint32_t seed = 815;
  DriftingAxis axis(seed);
  const int campaigns = std::getenv("NONIO_LONG") != nullptr ? 2000 : 1000;
  for (const std::uint32_t runs : {2U, 3U, 4U, 5U})
    for (const std::size_t targets : {5U, 9U, 11U, 21U})
      for (const double of_run : {0.0, 1.0}) {
        const Made made{.targets = targets, .runs = runs, .run = of_run * um};
        const int count = found(axis, made, campaigns);
        std::cout << runs << " runs, " << targets << " targets, zero of each run " << of_run
                  << " um: " << count << " of " << campaigns << "\n";
        EXPECT_LT(count, campaigns * (of_run > 0.0 ? 3 : 1) / 100) << "seed " << seed;
      }
}

// Campaign with an environment that is nearly stable: the readings alone have to show the drift.
TEST(Drift, IsCoveredByUWhateverItsSize) {
  constexpr std::uint32_t seed = 31415;
  DriftingAxis axis(seed);
  constexpr int campaigns = 400;
  for (const std::uint32_t runs : {2U, 3U, 5U})
    for (const bool wedge : {false, true})
      for (const double size : {0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0}) {
        int B = 0, mean = 0;
        double U_B = 0.0, U_mean = 0.0, U_R = 0.0;
        for (int n = 0; n < campaigns; ++n) {
          const AxisTest test = axis.measure({.runs = runs,
                                              .parallel = wedge ? 0.0 : size * um,
                                              .wedge = wedge ? size * um : 0.0});
          Budget budget;
          budget.U_EVE = 0.12 * um;
          budget.seen = drift_share(test);
          const Iso230Result r = evaluate_iso230_2(test, 2.0);
          const Iso230Uncertainty U = iso230_2_uncertainty(budget, runs, 2.0);
          mean += std::fabs(r.B_mean - true_B) <= U.B_mean;
          B += std::fabs(r.B - std::fabs(true_B)) <= U.B;
          U_B += U.B / campaigns, U_mean += U.B_mean / campaigns, U_R += U.R / campaigns;
        }
        std::cout << runs << " runs, " << (wedge ? "wedge " : "parallel ") << size
                  << " um: B_mean covered " << mean << ", B " << B << " of " << campaigns
                  << "; mean U(B_mean) " << U_mean / um << ", U(B) " << U_B / um << ", U(R) "
                  << U_R / um << " um\n";
        EXPECT_GE(mean, campaigns * 93 / 100) << "seed " << seed;
        EXPECT_GE(B, campaigns * 93 / 100) << "seed " << seed;
      }
}

}  // namespace
}  // namespace nonio::math::drift_test
