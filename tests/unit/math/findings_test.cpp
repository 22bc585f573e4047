// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "axis_builder.h"
#include "nonio/math/axis_analysis.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/reversal.h"

namespace nonio::math::findings_test {
namespace {

constexpr double um = 1e-6;

const Finding* find(const std::vector<Finding>& findings, const std::string& id) {
  for (const Finding& f : findings)
    if (f.id == id) return &f;
  return nullptr;
}

// Where one value for the whole axis would leave more than the largest reversal there is, none is
// advised (B from 1.40 to 1.56 um was).
TEST(Findings, NoBacklashValueIsAdvisedThatMakesTheLargestReversalLarger) {
  constexpr std::uint32_t seed = 140156;
  made::Random random(seed);
  made::Plan plan{{0.0, 0.11, 0.19, 0.31, 0.43, 0.5}, 5};
  int worse = 0, advised = 0;
  for (int round = 0; round < 400; ++round) {
    const auto test = made::arranged(
        plan,
        [&](double, int d, std::uint32_t) {
          return (d > 0 ? -0.7 : 0.0) * um + 1.2 * um * made::normal(random);
        },
        {}, random);
    const Reversal r = assess_reversal(test);
    std::vector<Finding> findings;
    reversal_findings(test, findings);
    const bool lost = find(findings, "reversal.lost-motion") != nullptr ||
                      find(findings, "reversal.positive") != nullptr;
    EXPECT_TRUE(!lost || r.largest_left < r.largest) << "seed " << seed << ", round " << round;
    advised += lost ? 1 : 0;
    worse += find(findings, "reversal.one-value-worse") != nullptr ? 1 : 0;
  }
  EXPECT_GT(worse, 0);
  EXPECT_GT(advised, 0);
}

// What one value leaves is a reversal at a target: its bound has the U of that, not of the mean.
TEST(Findings, OneBacklashValueLeavesNoMoreThanStated) {
  constexpr std::uint32_t seed = 5306;
  made::Random random(seed);
  made::Plan plan{{0.0, 0.11, 0.19, 0.31, 0.43, 0.5, 0.62, 0.74}, 3};
  int stated = 0, held = 0;
  for (int round = 0; round < 400; ++round) {
    const auto B = [](double x) { return (-5.0 + 0.4 * std::cos(9.0 * x)) * um; };
    const auto test = made::arranged(
        plan, [&](double x, int d, std::uint32_t) { return d * B(x) / 2.0; }, {0.5 * um}, random);
    std::vector<Finding> findings;
    reversal_findings(test, findings);
    const Finding* f = find(findings, "reversal.lost-motion");
    if (f == nullptr) continue;
    ++stated;
    const auto value = [&](const char* name) {
      return std::find_if(f->evidence.begin(), f->evidence.end(),
                          [&](const Number& n) { return n.name == name; })
          ->value;
    };
    double left = 0.0;
    for (const double x : test.targets) left = std::max(left, std::fabs(B(x) - value("mean")));
    held += left <= value("left");
  }
  EXPECT_GE(stated, 390) << "seed " << seed;
  EXPECT_GE(held, stated * 95 / 100) << "seed " << seed;
}

// Noise-free readings, as a simulation gives them: no test may stumble over 0/0.
TEST(Findings, WithoutAnyScatter) {
  made::Random random(1);
  made::Plan plan{{0.0, 0.11, 0.19, 0.31, 0.43, 0.5}, 5};
  const auto lost = made::arranged(
      plan, [](double x, int d, std::uint32_t) { return 3e-5 * x + (d > 0 ? -8 * um : 0.0); }, {},
      random);
  EXPECT_EQ(assess_reversal(lost).kind, Reversal::Kind::lost_motion);
  std::vector<Finding> findings;
  drift_findings(lost, findings);
  reversal_findings(lost, findings);
  scatter_findings(lost, findings);
  ASSERT_EQ(findings.size(), 1U) << findings.front().id;
  EXPECT_EQ(findings[0].id, "reversal.lost-motion");

  const auto still = made::arranged(
      plan, [](double, int, std::uint32_t) { return 0.0; }, {}, random);
  EXPECT_EQ(assess_reversal(still).kind, Reversal::Kind::none);
  findings.clear();
  drift_findings(still, findings);
  reversal_findings(still, findings);
  scatter_findings(still, findings);
  EXPECT_TRUE(findings.empty());
}

// A significant reversal that is small compared with A is information and requires no action.
TEST(Findings, ATinyReversalIsNoReasonToAct) {
  made::Random random(2);
  made::Plan plan{{0.0, 0.11, 0.19, 0.31, 0.43, 0.5}, 5};
  for (const double B : {-1 * um, -20 * um}) {
    std::vector<Finding> findings;
    const auto test = made::arranged(
        plan, [&](double x, int d, std::uint32_t) { return 4e-5 * x + (d > 0 ? B : 0.0); },
        {0.05 * um}, random);
    reversal_findings(test, findings);
    const Finding* f = find(findings, "reversal.lost-motion");
    ASSERT_NE(f, nullptr);
    EXPECT_EQ(f->attention, B < -10 * um);
  }
}

// Likewise a drift; and at least half of its step from run to run can be in the mean reversal.
TEST(Findings, ASmallDriftIsNoReasonToAct) {
  made::Random random(5);
  made::Plan plan{{0.0, 0.11, 0.19, 0.31, 0.43, 0.5}, 5};
  for (const double step : {0.1 * um, 3 * um}) {
    std::vector<Finding> findings;
    const auto test = made::arranged(
        plan, [&](double x, int, std::uint32_t run) { return 4e-5 * x + step * run; }, {0.02 * um},
        random);
    drift_findings(test, findings);
    const Finding* f = find(findings, "drift.parallel");
    ASSERT_NE(f, nullptr);
    EXPECT_EQ(f->attention, step > um);
    const auto in_B = std::find_if(f->evidence.begin(), f->evidence.end(),
                                   [](const Number& n) { return n.name == "in_B"; });
    ASSERT_NE(in_B, f->evidence.end());
    EXPECT_GT(in_B->value, step / 2.0);
    EXPECT_NEAR(in_B->value, step / 2.0, 0.06 * um);
  }
}

// 0 and 360 deg are one place. A drift within the passes differs in sign and is not meant.
TEST(Findings, ATurnThatDoesNotClose) {
  made::Random random(6);
  made::Plan plan{{}, 5};
  for (int i = 0; i <= 12; ++i) plan.targets.push_back(i * std::numbers::pi / 6.0);
  plan.rotary = true;
  const auto gap_of = [&](double closed, double drift) {
    std::vector<Finding> findings;
    turn_findings(made::arranged(
                      plan,
                      [&](double a, int d, std::uint32_t) {
                        return 1e-5 * std::sin(a) +
                               (closed + d * drift) * a / (2 * std::numbers::pi);
                      },
                      {0.5 * um}, random),
                  findings);
    const Finding* f = find(findings, "rotary.not-closed");
    return f == nullptr ? 0.0 : f->evidence.at(2).value;
  };
  EXPECT_NEAR(gap_of(20 * um, 0.0), 20 * um, um);
  EXPECT_NEAR(gap_of(-20 * um, 5 * um), -20 * um, um);
  EXPECT_EQ(gap_of(0.0, 0.0), 0.0);
  EXPECT_EQ(gap_of(0.0, 20 * um), 0.0);
  plan.runs = 1;  // no scatter is known
  EXPECT_EQ(gap_of(20 * um, 0.0), 0.0);
  plan.runs = 5;
  plan.targets.pop_back();
  EXPECT_EQ(gap_of(20 * um, 0.0), 0.0);
}

TEST(Findings, TargetsOutsideTheTravelAreNamed) {
  Observations o;
  for (const double x : {-0.01, 0.0, 0.3, 0.5, 0.501})
    for (const int d : {1, -1}) made::add(o, x, d, 0.0, 1);
  const AxisTest t = AxisTest::arrange(o);
  Axis axis;
  axis.name = "X";
  std::vector<Finding> findings;
  plan_findings(t, o, &axis, findings);
  EXPECT_EQ(find(findings, "targets.outside-travel"), nullptr);
  axis.travel = {0.0, 0.5};
  plan_findings(t, o, &axis, findings);
  const Finding* f = find(findings, "targets.outside-travel");
  ASSERT_NE(f, nullptr);
  EXPECT_TRUE(f->attention);
  EXPECT_EQ(f->texts.at(0).second, "-10; 501 mm");
}

// ISO R+ 4.516 against R- 1.756 and the like: s of one direction more than twice the other's.
TEST(Findings, OneOutlierMakesNoDirectionScatterMore) {
  made::Random random(3);
  made::Plan plan{{0.0, 0.11, 0.19, 0.31, 0.43, 0.5}, 5};
  auto o = made::observe(
      plan, [](double, int, std::uint32_t) { return 0.0; }, {0.3 * um}, random);
  EXPECT_FALSE(scatter_is_asymmetric(AxisTest::arrange(o)));
  o.deviation[4] += 8 * um;
  EXPECT_FALSE(scatter_is_asymmetric(AxisTest::arrange(o)));
}

TEST(Findings, RotaryEvidenceIsAngular) {
  made::Random random(4);
  made::Plan plan{{0.0, 0.7, 1.6, 2.5, 3.1, 4.0, 4.8, 5.5}, 5};
  plan.rotary = true;
  std::vector<Finding> findings;
  reversal_findings(made::arranged(
                        plan, [](double a, int d, std::uint32_t) { return d * 2e-5 * std::sin(a); },
                        {um}, random),
                    findings);
  const Finding* f = find(findings, "reversal.elastic");
  ASSERT_NE(f, nullptr);
  EXPECT_EQ(f->evidence.at(0).quantity, Quantity::angular_deviation);
  EXPECT_NEAR(f->evidence.at(0).value, 2e-5, 1e-6);
}

TEST(Findings, TargetsAreNamedByTheirPosition) {
  Observations o;
  for (const double x : {0.1, 1.23456, 0.15}) made::add(o, x, 1, 0.0, 1);
  const AxisTest t = AxisTest::arrange(o);
  EXPECT_EQ(target_list(t, {0, 1, 2}), "100; 150; 1234.56 mm");
}

TEST(Budget, WhatIsMissingIsNamedByItsKey) {
  Observations o;
  for (const double x : {0.0, 1.0}) made::add(o, x, 1, 0.0, 1);
  Campaign c;
  c.machine.axes.push_back({});
  c.machine.axes[0].name = "X";
  c.instrument.U_fixed = 1e-7;
  c.environment.drift = 1e-6;
  const auto of = uncertainty_budget(c, c.environment, "X", AxisTest::arrange(o));
  EXPECT_FALSE(of.budget);
  const Finding f = budget_finding(of, false);
  EXPECT_EQ(f.id, "uncertainty.no-data");
  EXPECT_EQ(f.texts.at(0).second,
            "instrument.U_per_m_um, environment.misalignment_mm, "
            "environment.temperature_range_K, environment.temperature_difference_K, "
            "environment.expansion_range_um_per_m_K, machine.axes.X.expansion_um_per_m_K");
}

struct Given {
  Campaign campaign;
  Measurement measurement;
  Observations observations;
  Settings options;
  AnalysisInput input() const { return {campaign, measurement, observations, options}; }
};

Given linear() {
  Given g;
  g.measurement.axis = "X";
  g.measurement.kind = "axis";
  for (const double x : {0.0, 1.0}) made::add(g.observations, x, 1, 0.0, 1);
  return g;
}

TEST(Analysis, RefusesWhatIsNotAnAxisTest) {
  Given g = linear();
  EXPECT_TRUE(begin_axis_analysis(g.input()));
  g.measurement.axis = "Y";
  const auto other = begin_axis_analysis(g.input());
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message, "expected the readings of axis 'Y', found those of 'X'");
  g = linear();
  g.observations.angular = true;
  EXPECT_FALSE(begin_axis_analysis(g.input()));
  g = linear();
  for (auto& approach : g.observations.axes[0].approach) approach = 0;
  EXPECT_FALSE(begin_axis_analysis(g.input()));
  EXPECT_FALSE(begin_axis_analysis(Given{}.input()));
}

}  // namespace
}  // namespace nonio::math::findings_test
