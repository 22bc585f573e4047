// SPDX-License-Identifier: Apache-2.0
//
// A planted effect is found, and named right, in nearly every campaign.
#include <gtest/gtest.h>

#include <iostream>
#include <set>

#include "axis_builder.h"
#include "nonio/math/axis_findings.h"

namespace nonio::detection_test {
namespace {

constexpr double um = 1e-6;

struct Planted {
  const char* name;
  std::set<std::string> wanted;     // all of these
  std::set<std::string> forbidden;  // none of these
  made::Noise noise;
  made::Truth truth;
  bool rotary = false;
  std::uint32_t runs = 5;
};

void PrintTo(const Planted& p, std::ostream* out) { *out << p.name; }

class Detection : public testing::TestWithParam<Planted> {};

TEST_P(Detection, APlantedErrorIsFoundAtItsRate) {
  const Planted& c = GetParam();
  constexpr int campaigns = 300;
  int found = 0, wrong = 0;
  constexpr std::uint64_t seed = 99;
  made::Random random(seed);
  for (int n = 0; n < campaigns; ++n) {
    made::Plan plan;
    plan.rotary = c.rotary;
    plan.runs = c.runs;
    plan.targets = made::spread_targets(random, 13, c.rotary ? 5.8 : 1.8);
    std::vector<Finding> findings;
    const auto test = made::arranged(plan, c.truth, c.noise, random);
    math::drift_findings(test, findings);
    math::reversal_findings(test, findings);
    math::scatter_findings(test, findings);
    std::set<std::string> ids;
    for (const Finding& f : findings) ids.insert(f.id);
    bool all = true, none = true;
    for (const auto& id : c.wanted) all = all && ids.count(id) > 0;
    for (const auto& id : c.forbidden) none = none && ids.count(id) == 0;
    found += all ? 1 : 0;
    wrong += none ? 0 : 1;
  }
  std::cout << c.name << ": found " << found << ", wrongly named " << wrong << " of " << campaigns
            << ", seed " << seed << "\n";
  EXPECT_GE(found, campaigns * 95 / 100);
  EXPECT_LE(wrong, campaigns * 4 / 100);
}

double warm(std::uint32_t run) { return 1.0 - std::exp(-static_cast<double>(run - 1) / 1.5); }

INSTANTIATE_TEST_SUITE_P(
    Planted, Detection,
    testing::Values(
        Planted{"parallel_drift",
                {"drift.parallel"},
                {"drift.wedge"},
                {1 * um, 0, 0.2 * um},
                [](double, int, std::uint32_t run) { return 1.5 * um * run; }},
        Planted{"warming_up",
                {"drift.parallel"},
                {"drift.wedge"},
                {0.5 * um, 0, 0.1 * um},
                [](double, int, std::uint32_t run) { return 10 * um * warm(run); }},
        Planted{"wedge",
                {"drift.wedge"},
                {"drift.parallel"},
                {0.7 * um, 0, 0.2 * um},
                [](double x, int, std::uint32_t run) { return 1.5 * um * run * x; }},
        Planted{"wedge_warming_up",
                {"drift.wedge"},
                {"drift.parallel"},
                {0.5 * um, 0, 0.1 * um},
                [](double x, int, std::uint32_t run) { return 10 * um * warm(run) * x; }},
        Planted{"both_drifts",
                {"drift.wedge", "drift.parallel"},
                {},
                {0.5 * um, 0, 0.1 * um},
                [](double x, int, std::uint32_t run) { return 2 * um * run * (1.0 + x); }},
        Planted{
            "lost_motion_in_drift",
            {"drift.parallel", "reversal.lost-motion"},
            {"reversal.not-constant"},
            {0.5 * um, 0, 0.2 * um},
            // U of the drift is below half of it: else no value is advised.
            [](double, int d, std::uint32_t run) { return 4 * um * run - (d > 0 ? 9 * um : 0); }},
        Planted{"lost_motion_two_runs",
                {"reversal.lost-motion"},
                {"reversal.not-constant"},
                {0.5 * um, 0, 0},
                [](double, int d, std::uint32_t) { return d > 0 ? -4 * um : 0; },
                false,
                2},
        Planted{"lost_motion_one_run",
                {"reversal.lost-motion"},
                {"reversal.not-constant"},
                {0.5 * um, 0, 0},
                [](double, int d, std::uint32_t) { return d > 0 ? -6 * um : 0; },
                false,
                1},
        Planted{"reversal_along_travel",
                {"reversal.not-constant"},
                {"reversal.lost-motion", "reversal.positive"},
                {0.5 * um, 0.5 * um, 0.2 * um},
                [](double x, int d, std::uint32_t) { return d * 3 * um * std::cos(4.0 * x); }},
        Planted{"asymmetric",
                {"repeatability.asymmetric"},
                {"reading.suspect"},
                {0.5 * um, 0, 0, 2.5},
                [](double, int, std::uint32_t) { return 0.0; }},
        Planted{"opposed",
                {"reversal.elastic", "reversal.not-constant"},
                {"eccentricity"},
                {1 * um, 0, 0.3 * um},
                [](double a, int d, std::uint32_t) { return d * 3 * um * std::sin(a + 0.4); },
                true},
        Planted{"concordant",
                {"eccentricity"},
                {"reversal.elastic", "reversal.not-constant"},
                {1 * um, 0, 0.3 * um},
                [](double a, int, std::uint32_t) { return 5 * um * std::sin(a + 0.4); },
                true}),
    [](const testing::TestParamInfo<Planted>& i) { return std::string(i.param.name); });

TEST(Detection, AMisreadingIsNamedAndOnlyThat) {
  constexpr int campaigns = 300;
  int named = 0, others = 0;
  made::Random random(5);
  for (int n = 0; n < campaigns; ++n) {
    made::Plan plan;
    plan.targets = made::spread_targets(random, 11, 1.0);
    auto o = made::observe(
        plan, [](double, int, std::uint32_t run) { return 3 * um * run; }, {0.5 * um, 0, 0.3 * um},
        random);
    const std::size_t bad = random() % o.size();
    o.deviation[bad] += 5 * um * (random() % 2 == 0 ? 1 : -1);
    std::vector<Finding> findings;
    math::scatter_findings(math::AxisTest::arrange(o), findings);
    for (const Finding& f : findings) {
      if (f.id != "reading.suspect") continue;
      const bool right = f.evidence[0].value == o.run[bad] &&
                         f.evidence[1].value == o.axes[0].position[bad] &&
                         f.evidence[2].value == o.deviation[bad];
      ++(right ? named : others);
      if (right) {
        EXPECT_NEAR(f.evidence[4].value, o.deviation[bad] > f.evidence[3].value ? 5 * um : -5 * um,
                    2.5 * um);
      }
    }
  }
  std::cout << "named " << named << " of " << campaigns << ", others " << others << ", seed 5\n";
  EXPECT_GE(named, campaigns * 95 / 100);
  EXPECT_LE(others, campaigns * 3 / 100);
}

TEST(Detection, ATargetThatDiffersFromTheOthersIsNamed) {
  constexpr int campaigns = 300;
  int named = 0, others = 0;
  made::Random random(6);
  for (int n = 0; n < campaigns; ++n) {
    made::Plan plan;
    plan.targets = made::spread_targets(random, 13, 1.8);
    const double bad = plan.targets[random() % 13];
    const auto truth = [&](double x, int, std::uint32_t) {
      return 5 * um * x + 2 * um * std::sin(x) + (x == bad ? 6 * um : 0.0);
    };
    std::vector<Finding> findings;
    math::scatter_findings(made::arranged(plan, truth, {0.5 * um, 1 * um, 0}, random), findings);
    for (const Finding& f : findings)
      if (f.id == "target.worst") ++(f.evidence[0].value == bad ? named : others);
  }
  std::cout << "named " << named << " of " << campaigns << ", others " << others << ", seed 6\n";
  EXPECT_GE(named, campaigns * 90 / 100);
  EXPECT_LE(others, campaigns * 3 / 100);
}

}  // namespace
}  // namespace nonio::detection_test
