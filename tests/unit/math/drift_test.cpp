// SPDX-License-Identifier: Apache-2.0
//
// Drift that goes on while the axis is measured: + upwards, then - downwards, run after run. How often
// it is found, how often a stationary axis is accused, and whether U covers the reversal.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <random>
#include <string>

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
  double time_constant = INFINITY;     ///< of a drift that slows down, in parts of the test
  double reading = 0.3 * um;           ///< scatter
  double run = 0.0, pass = 0.0;        ///< offset that each run, each pass has for itself
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
    double taken = 0.0, mean_course = 0.0;
    for (std::uint32_t run = 1; run <= made.runs; ++run) {
      const double of_run = made.run * normal();
      for (const int d : made.minus_first ? std::vector{-1, 1} : std::vector{1, -1}) {
        const double of_pass = of_run + made.pass * normal();
        for (std::size_t k = 0; k < m; ++k) {
          const double x = targets[d > 0 ? k : m - 1 - k], share = x / travel;
          const double B = true_B + made.elastic * std::cos(3.0 * share);
          const double course = std::isinf(made.time_constant)
                                    ? taken / all
                                    : 1.0 - std::exp(-taken / all / made.time_constant);
          mean_course += course / all;
          o.axes[0].position.push_back(x);
          o.axes[0].approach.push_back(static_cast<std::int8_t>(d));
          o.run.push_back(run);
          o.deviation.push_back(error(share) + d * B / 2.0 + of_pass + made.reading * normal() +
                                (made.parallel + made.wedge * share) * course);
          taken += 1.0;
        }
      }
    }
    up.clear(), down.clear();
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (const double x : targets) {
      const double at = error(x / travel) + made.wedge * mean_course * x / travel,
                   B = true_B + made.elastic * std::cos(3.0 * x / travel),
                   half = std::fabs(B) / 2.0;
      up.push_back(at + B / 2.0), down.push_back(at - B / 2.0);
      for (const int both : {0, 1}) {
        low[both] = std::min(low[both], both != 0 ? at : at - half);
        high[both] = std::max(high[both], both != 0 ? at : at + half);
      }
    }
    E = high[0] - low[0], M = high[1] - low[1];
    return AxisTest::arrange(o);
  }

  double E = 0.0, M = 0.0;       ///< of the last axis, in its mean state during the test
  std::vector<double> up, down;  ///< its deviations at the targets

 private:
  static double error(double share) { return 10.0 * um * share + 3.0 * um * std::sin(4.0 * share); }
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

TEST(Drift, IsFoundIfItSlowsDown) {
  constexpr std::uint32_t seed = 1618;
  DriftingAxis axis(seed);
  constexpr int campaigns = 200;
  for (const std::uint32_t runs : {3U, 4U, 5U})
    for (const double time_constant : {0.2, 0.3, 0.4, 0.6}) {
      const Made made{.targets = 20,
                      .runs = runs,
                      .parallel = 8.0 * um,
                      .time_constant = time_constant,
                      .reading = 0.5 * um,
                      .elastic = 3.0 * um};
      const int count = found(axis, made, campaigns);
      std::cout << runs << " runs, time constant " << time_constant << ": found " << count << " of "
                << campaigns << "\n";
      EXPECT_GE(count, campaigns * 95 / 100) << "seed " << seed;
    }
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
      for (const auto& [of_run, of_pass] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}) {
        const Made made{.targets = targets, .runs = runs, .run = of_run * um, .pass = of_pass * um};
        const int count = found(axis, made, campaigns);
        std::cout << runs << " runs, " << targets << " targets, zero of each run " << of_run
                  << " um, of each pass " << of_pass << " um: " << count << " of " << campaigns
                  << "\n";
        EXPECT_LT(count, campaigns *
                             (of_pass > 0.0  ? 4
                              : of_run > 0.0 ? 3
                                             : 1) /
                             100)
            << "seed " << seed;
      }
}

std::optional<double> stated_by_finding(const AxisTest& test) {
  std::vector<Finding> findings;
  drift_findings(test, findings);
  for (const Finding& f : findings)
    for (const Number& n : f.evidence)
      if (n.name == "in_B") return n.value;
  return {};
}

/// E and M that are left if a table compensates the means of the test.
std::pair<double, double> left_after(const Iso230Result& r, const DriftingAxis& axis) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (std::size_t i = 0; i < axis.up.size(); ++i) {
    const double up = axis.up[i] - r.points[i].mean_plus,
                 down = axis.down[i] - r.points[i].mean_minus;
    low[0] = std::min({low[0], up, down}), high[0] = std::max({high[0], up, down});
    low[1] = std::min(low[1], (up + down) / 2.0), high[1] = std::max(high[1], (up + down) / 2.0);
  }
  return {high[0] - low[0], high[1] - low[1]};
}

// Campaign with an environment that is nearly stable: the readings alone have to show the drift.
void expect_covered(DriftingAxis& axis, const Made& made, int campaigns, const std::string& what) {
  constexpr int kinds = 7;
  int within[kinds] = {};
  double U_of[kinds] = {};
  for (int n = 0; n < campaigns; ++n) {
    const AxisTest test = axis.measure(made);
    Budget budget;
    budget.U_EVE = 0.12 * um;
    budget.seen = drift_share(test);
    const Iso230Result r = evaluate_iso230_2(test, 2.0);
    const Iso230Uncertainty U = iso230_2_uncertainty(budget, made.runs, 2.0);
    const auto left = left_after(r, axis);
    budget.seen.E = budget.seen.E_after, budget.seen.M = budget.seen.M_after;
    const Iso230Uncertainty of_after = iso230_2_uncertainty(budget, made.runs, 2.0);
    const double error[] = {r.B_mean - true_B, r.B - std::fabs(true_B), r.E - axis.E,
                            r.M - axis.M,      r.B_mean - true_B,       left.first,
                            left.second},
                 stated[] = {
                     U.B_mean,   U.B,       U.E, U.M, stated_by_finding(test).value_or(U.B_mean),
                     of_after.E, of_after.M};
    for (int k = 0; k < kinds; ++k)
      within[k] += std::fabs(error[k]) <= stated[k], U_of[k] += stated[k] / campaigns / um;
  }
  std::cout << made.runs << " runs, " << what << ": of " << campaigns << " within U:";
  const char* const names[] = {"B_mean",  "B",      "E", "M", "B_mean by the finding",
                               "E after", "M after"};
  for (int k = 0; k < kinds; ++k) {
    std::cout << " " << names[k] << " " << within[k] << " (" << U_of[k] << " um)";
    EXPECT_GE(within[k], campaigns * 93 / 100) << names[k] << ", " << what;
  }
  std::cout << "\n";
}

TEST(Drift, IsCoveredByUWhateverItsSize) {
  constexpr std::uint32_t seed = 31415;
  SCOPED_TRACE("seed " + std::to_string(seed));
  DriftingAxis axis(seed);
  for (const std::uint32_t runs : {2U, 3U, 5U})
    for (const bool wedge : {false, true})
      for (const double size : {0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0})
        expect_covered(
            axis,
            {.runs = runs, .parallel = wedge ? 0.0 : size * um, .wedge = wedge ? size * um : 0.0},
            400, (wedge ? "wedge " : "parallel ") + std::to_string(size) + " um");
}

TEST(Drift, IsCoveredByUIfItSlowsDown) {
  constexpr std::uint32_t seed = 27182;
  SCOPED_TRACE("seed " + std::to_string(seed));
  DriftingAxis axis(seed);
  for (const std::uint32_t runs : {2U, 3U, 5U})
    for (const bool wedge : {false, true})
      for (const double size : {4.0, 12.0})
        for (const double time_constant : {0.2, 0.35, 0.6})
          expect_covered(axis,
                         {.targets = 20,
                          .runs = runs,
                          .parallel = wedge ? 0.0 : size * um,
                          .wedge = wedge ? size * um : 0.0,
                          .time_constant = time_constant},
                         200,
                         (wedge ? "wedge " : "parallel ") + std::to_string(size) +
                             " um, time constant " + std::to_string(time_constant));
}

}  // namespace
}  // namespace nonio::math::drift_test
