// SPDX-License-Identifier: Apache-2.0
//
// A clean machine gives no findings: the rate of false alarms of each test, over many seeds. Every
// test works at 1 %; the bound leaves room for the count of seeds and for what is approximate.
#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <numbers>

#include "axis_builder.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/reversal.h"

namespace nonio::false_alarm_test {
namespace {

struct Clean {
  const char* name;
  std::size_t targets;
  std::uint32_t runs;
  made::Noise noise;
  double B;  // m or rad
  bool rotary;
  std::uint64_t seed;
  bool closed = false;  ///< rotary: evenly over the turn, 0 and 360 deg both
};

void PrintTo(const Clean& c, std::ostream* out) { *out << c.name; }

class FalseAlarms : public testing::TestWithParam<Clean> {};

double smooth(double x) { return 8e-6 * x + 3e-6 * std::sin(1.3 * x) - 2e-6 * std::cos(2.9 * x); }

TEST_P(FalseAlarms, AreRare) {
  const Clean& c = GetParam();
  constexpr int campaigns = 2000;
  std::map<std::string, int> alarms;
  made::Random random(c.seed);
  for (int n = 0; n < campaigns; ++n) {
    made::Plan plan;
    plan.runs = c.runs;
    plan.rotary = c.rotary;
    plan.targets = made::spread_targets(random, c.targets, c.rotary ? 5.5 : 1.8);
    if (c.closed)
      for (std::size_t i = 0; i < c.targets; ++i)
        plan.targets[i] =
            2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(c.targets - 1);
    const auto truth = [&](double x, int d, std::uint32_t) {
      return (c.rotary ? 2e-6 * std::sin(3.0 * x) + 2e-6 * std::cos(2.0 * x) : smooth(x)) +
             (d > 0 ? c.B : 0.0);
    };
    const auto test = made::arranged(plan, truth, c.noise, random);
    std::vector<Finding> findings;
    math::drift_findings(test, findings);
    math::reversal_findings(test, findings);
    math::scatter_findings(test, findings);
    math::turn_findings(test, findings);
    std::map<std::string, int> once;
    for (const Finding& f : findings) once[f.id] = 1;
    for (const auto& [id, one] : once) alarms[id] += one;
  }
  const std::string planted = c.B < 0.0 ? "reversal.lost-motion" : "reversal.positive";
  if (c.B != 0.0) {
    EXPECT_GE(alarms[planted], campaigns * 98 / 100) << "seed " << c.seed;
    alarms.erase(planted);
  }
  std::cout << c.name << ", seed " << c.seed << ":";
  for (const auto& [id, count] : alarms) {
    std::cout << " " << id << " " << 100.0 * count / campaigns << " %";
    EXPECT_LE(count, campaigns * 2 / 100) << id << ", seed " << c.seed;
  }
  std::cout << "\n";
}

constexpr double um = 1e-6;
INSTANTIATE_TEST_SUITE_P(
    Clean, FalseAlarms,
    testing::Values(Clean{"plain", 11, 5, {1 * um, 0, 0}, -8 * um, false, 11},
                    Clean{"no_reversal", 11, 5, {1 * um, 0, 0}, 0, false, 12},
                    Clean{"offsets_of_runs", 11, 5, {1 * um, 3 * um, 0}, -8 * um, false, 13},
                    Clean{"offsets_of_runs_no_reversal", 11, 5, {1 * um, 3 * um, 0}, 0, false, 14},
                    Clean{"offsets_of_passes", 21, 5, {0.5 * um, 0, 1 * um}, 0, false, 15},
                    Clean{"offsets_of_both", 21, 5, {0.5 * um, 1 * um, 0.5 * um}, 0, false, 16},
                    Clean{"three_runs", 9, 3, {1 * um, 1 * um, 0.3 * um}, 0, false, 17},
                    Clean{"two_runs", 9, 2, {1 * um, 0.5 * um, 0}, 0, false, 18},
                    Clean{"ten_runs", 8, 10, {1 * um, 2 * um, 0}, 0, false, 19},
                    Clean{"four_runs", 30, 4, {1 * um, 2 * um, 0.2 * um}, 0, false, 20},
                    Clean{"rotary", 12, 5, {1 * um, 0, 0}, 10 * um, true, 21},
                    Clean{"rotary_no_reversal", 8, 5, {1 * um, 1 * um, 0}, 0, true, 22},
                    Clean{"closed_turn", 13, 5, {1 * um, 0, 0}, -10 * um, true, 24, true},
                    Clean{"closed_turn_offsets", 9, 3, {1 * um, 1 * um, 1 * um}, 0, true, 25, true},
                    Clean{"closed_turn_many", 37, 5, {1 * um, 0, 0.3 * um}, 0, true, 26, true},
                    Clean{"five_angles", 6, 5, {1 * um, 0, 0}, -10 * um, true, 27, true},
                    Clean{"one_run", 13, 1, {1 * um, 0, 0}, 0, false, 23}),
    [](const testing::TestParamInfo<Clean>& i) { return std::string(i.param.name); });

}  // namespace
}  // namespace nonio::false_alarm_test
