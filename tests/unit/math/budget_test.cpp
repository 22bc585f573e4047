// SPDX-License-Identifier: Apache-2.0
// The budget of readings: each input by hand, common inputs, and inputs that were not stated.
#include "nonio/math/budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "nonio/math/distributions.h"
#include "nonio/math/uncertainty.h"

namespace nonio::math::budget_test {
namespace {

constexpr double um = 1e-6;

Campaign stated() {
  Campaign c;
  c.machine.axes.push_back(Axis{.name = "X"});
  c.machine.axes.back().expansion = 10e-6;
  c.instrument.U_fixed = 2 * um;
  c.instrument.U_per_length = 4 * um;
  c.environment.misalignment = 2e-3;
  c.environment.temperature_range = 0.5;
  c.environment.temperature_difference = 3.0;
  c.environment.expansion_range = 2 * um;
  c.environment.drift = 6 * um;
  return c;
}

/// Stops at 0, 1, 2 m.
BudgetLine line(const Campaign& c, std::size_t group = 0,
                BudgetLine::Kind kind = BudgetLine::Kind::length) {
  BudgetLine l;
  l.kind = kind;
  l.length = {0.0, 1.0, 2.0};
  l.zeroed = kind == BudgetLine::Kind::length;
  l.group = group;
  const std::string axis = "X";
  const double whole = 1.0;
  put_expansion(l, c, {&axis, 1}, {&whole, 1});
  return l;
}

double share(const ReadingModel& m, const std::string& id, const std::vector<double>& row) {
  const Shares all = m.shares(row);
  for (std::size_t i = 0; i < m.inputs.size(); ++i)
    if (m.inputs[i].is.id == id) return all.u[i];
  ADD_FAILURE() << "no input " << id;
  return NAN;
}

TEST(Budget, EachInputByHand) {
  const Campaign c = stated();
  const ReadingModel m = reading_model(c, c.environment, {line(c)});
  EXPECT_TRUE(m.missing.empty());
  const std::vector<double> last{0, 0, 1};
  EXPECT_NEAR(share(m, "device-fixed", last), 1 * um, 1e-15);
  EXPECT_NEAR(share(m, "device-length", last), 2 * um * 2.0, 1e-15);
  // 2 mm over 2 m: 4e-6/(2 * 4) for each metre, one-sided.
  EXPECT_NEAR(share(m, "misalignment", last), 2.0 * 0.5e-6 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(share(m, "temperature", last), 2.0 * 10e-6 * 0.5 / std::sqrt(12.0), 1e-15);
  EXPECT_NEAR(share(m, "expansion", last), 2.0 * 3.0 * 2e-6 / std::sqrt(12.0), 1e-15);
  EXPECT_NEAR(share(m, "drift", last), 6 * um / std::sqrt(3.0), 1e-15);
  // Half of the way, half of the variance of the walk; the zero has neither.
  EXPECT_NEAR(share(m, "drift", {0, 1, 0}), 6 * um / std::sqrt(6.0), 1e-15);
  EXPECT_EQ(share(m, "drift", {1, 0, 0}), 0.0);
  EXPECT_EQ(share(m, "device-fixed", {1, 0, 0}), 0.0);
}

TEST(Budget, WhatOneInstrumentHasInCommonDropsOutOfADifference) {
  const Campaign c = stated();
  const ReadingModel m = reading_model(c, c.environment, {line(c, 0), line(c, 1)});
  const std::vector<double> difference{0, 0, 1, 0, 0, -1}, sum{0, 0, 1, 0, 0, 1};
  EXPECT_NEAR(share(m, "device-length", difference), 0.0, 1e-18);
  EXPECT_NEAR(share(m, "device-length", sum), 2 * um * 4.0, 1e-15);
  // What each line has for itself does not, whatever the sign.
  for (const char* id : {"device-fixed", "drift"}) {
    EXPECT_GT(share(m, id, difference), 0.1 * um) << id;
    EXPECT_NEAR(share(m, id, difference), share(m, id, sum), 1e-15) << id;
  }
  // It is not stated whether lines share a sensor and a temperature: the larger u is taken, that of
  // separate ones in a difference and of a common one in a sum.
  const std::vector<double> one_line{0, 0, 1, 0, 0, 0};
  for (const char* id : {"temperature", "expansion"}) {
    const double each = share(m, id, one_line);
    EXPECT_NEAR(share(m, id, difference), std::sqrt(2.0) * each, 1e-15) << id;
    EXPECT_NEAR(share(m, id, sum), 2.0 * each, 1e-15) << id;
  }
  // Cosine errors are between 0 and a limit in all lines: a difference has a sixth of its square,
  // a sum their mean (the limit) and the same.
  const double limit = 2.0 * 0.5e-6;  // of one line: 2 m, 2 mm
  EXPECT_NEAR(share(m, "misalignment", difference), limit / std::sqrt(6.0), 1e-15);
  EXPECT_NEAR(share(m, "misalignment", sum), limit * std::sqrt(1.0 + 1.0 / 6.0), 1e-15);
  // Lines of one measurement have it together.
  const ReadingModel one = reading_model(c, c.environment, {line(c, 7), line(c, 7)});
  EXPECT_NEAR(share(one, "temperature", difference), 0.0, 1e-18);
}

TEST(Budget, CoordinatesHaveProbeAndBall) {
  Campaign c = stated();
  const auto lines = [&] { return std::vector{line(c, 0, BudgetLine::Kind::coordinate)}; };
  const ReadingModel gap = reading_model(c, c.environment, lines());
  EXPECT_EQ(gap.missing, (std::vector<std::string>{"instrument.sphere_um", "instrument.probe_um"}));
  c.instrument.sphere = 3 * um;
  c.instrument.probe = 5 * um;
  const ReadingModel m = reading_model(c, c.environment, lines());
  const std::vector<double> mean{1.0 / 3, 1.0 / 3, 1.0 / 3};
  EXPECT_NEAR(share(m, "sphere", mean), 3 * um / std::sqrt(36.0), 1e-15);  // averages out
  EXPECT_NEAR(share(m, "probe", mean), 5 * um / std::sqrt(12.0), 1e-15);   // does not
  EXPECT_NEAR(share(m, "device-fixed", mean), 1 * um, 1e-15);
  for (const auto& input : m.inputs) EXPECT_NE(input.is.id, "misalignment");
}

TEST(Budget, AContributionThatWasNotStatedIsNamed) {
  const struct {
    const char* key;
    void (*forget)(Campaign&);
  } gaps[] = {
      {"instrument.U_fixed_um", [](Campaign& c) { c.instrument.U_fixed.reset(); }},
      {"instrument.U_per_m_um", [](Campaign& c) { c.instrument.U_per_length.reset(); }},
      {"environment.misalignment_mm", [](Campaign& c) { c.environment.misalignment.reset(); }},
      {"environment.temperature_range_K",
       [](Campaign& c) { c.environment.temperature_range.reset(); }},
      {"environment.temperature_difference_K",
       [](Campaign& c) { c.environment.temperature_difference.reset(); }},
      {"environment.expansion_range_um_per_m_K",
       [](Campaign& c) { c.environment.expansion_range.reset(); }},
      {"environment.drift_um", [](Campaign& c) { c.environment.drift.reset(); }},
      {"machine.axes.X.expansion_um_per_m_K",
       [](Campaign& c) { c.machine.axes[0].expansion.reset(); }},
      {"instrument.U_fixed_um (0: no instrument is exact)",
       [](Campaign& c) { c.instrument.U_fixed = c.instrument.U_per_length = 0.0; }},
      {"instrument.temperature_range_K",
       [](Campaign& c) { c.instrument.expansion = 8e-6, c.instrument.expansion_range = 1e-6; }}};
  for (const auto& gap : gaps) {
    Campaign c = stated();
    gap.forget(c);
    const ReadingModel m = reading_model(c, c.environment, {line(c)});
    EXPECT_EQ(m.missing, std::vector<std::string>{gap.key});
    BudgetOf budget(m, 1 * um, 10.0, Quantity::deviation);
    const Value v = budget.value("E", 5 * um, Quantity::deviation, 1 * um,
                                 m.shares(std::vector{0.0, 0.0, 1.0}));
    EXPECT_FALSE(v.U) << gap.key;
    ASSERT_TRUE(v.repeatability) << gap.key;
    EXPECT_NEAR(*v.repeatability, v.k * um, 1e-12);
    EXPECT_NEAR(v.k, 2.284,
                0.001);  // Student's t, 95.45 %, 10 degrees of freedom (GUM, table G.2: 2.28)
    EXPECT_TRUE(budget.budget().results.empty());
  }
}

TEST(Budget, CoverageFactorOfTheEffectiveDegreesOfFreedom) {
  const Campaign c = stated();
  const ReadingModel m = reading_model(c, c.environment, {line(c)});
  BudgetOf budget(m, 3 * um, 5.0, Quantity::deviation);
  Shares shares;
  shares.u = {0.0, 4 * um};  // the part with the length
  const Expanded e = budget.expand(3 * um, shares);
  EXPECT_NEAR(e.u, 5 * um, 1e-15);
  EXPECT_NEAR(e.dof, 5.0 * std::pow(5.0 / 3.0, 4), 1e-9);  // 38.6
  EXPECT_GT(e.k, 2.05);
  EXPECT_LT(e.k, 2.07);
  EXPECT_NEAR(*e.U, e.k * 5 * um, 1e-15);
  shares.u = {0.0, 300 * um};
  EXPECT_EQ(budget.expand(3 * um, shares).k, 2.0);
}

/// P within U of a rectangle, of two equal ones (a triangle), and of a rectangle with a normal part.
TEST(Budget, CoverageFactorOfRectangles) {
  EXPECT_EQ(shape_factor(0.0), 1.0);
  EXPECT_NEAR(2.0 * shape_factor(-1.2), 0.9545 * std::sqrt(3.0), 1e-4);
  // A triangle of variance 1 is within x in 1 - (1 - x/sqrt 6)^2: the factor is near enough.
  const double x = 2.0 * shape_factor(-0.6);
  EXPECT_NEAR(1.0 - std::pow(1.0 - x / std::sqrt(6.0), 2), 0.952, 0.008);
  EXPECT_NEAR(shape_factor(-1e-3), 1.0, 2e-3);
  const Campaign c = stated();
  const ReadingModel m = reading_model(c, c.environment, {line(c)});
  BudgetOf budget(m, 1 * um, INFINITY, Quantity::deviation);
  Shares shares;
  for (const auto& input : m.inputs) {
    const bool warm = input.is.id == "temperature";
    shares.u.push_back(warm ? 100 * um : 0.0);
    shares.rectangular.push_back(warm ? 100 * um : 0.0);
  }
  EXPECT_NEAR(budget.expand(0.0, shares).k, 1.653, 0.001);
  EXPECT_NEAR(budget.expand(1000 * um, shares).k, 2.0, 0.001);
}

/// A random walk runs through the visits: there and back, its slope cancels in the means.
TEST(Budget, DriftGoesThroughTheVisits) {
  const Campaign c = stated();
  BudgetLine there = line(c, 0, BudgetLine::Kind::length);
  there.zeroed = false;
  for (const auto& [time, reading] :
       {std::pair{0.0, 0U}, {0.2, 1U}, {0.4, 2U}, {0.6, 2U}, {0.8, 1U}, {1.0, 0U}})
    there.visits.push_back({time, reading, 0.5});
  const ReadingModel m = reading_model(c, c.environment, {there});
  // By hand: what comes after each step of 1/5 counts: 2 - 0 is 1/2 (0 0 1 1 0 -1), by its rests
  // 1/2, 1/2, 0, -1/2, -1/2.
  const double u = 6 * um / std::sqrt(3.0);
  EXPECT_NEAR(share(m, "drift", {-1, 0, 1}), u * std::sqrt(4 * 0.25 / 5.0), 1e-15);
}

/// A scatter that a drift has made counts once; the drift never for less than the scatter.
TEST(Budget, DriftInTheScatterCountsOnce) {
  const Campaign c = stated();
  BudgetLine l = line(c);
  l.walk_seen = 0.25;
  const ReadingModel m = reading_model(c, c.environment, {l});
  const double u = 6 * um / std::sqrt(3.0);
  const auto drift = [&](double scatter, const std::string& source) {
    BudgetOf budget(m, scatter, 20.0, Quantity::deviation, source);
    budget.value("f", 0.0, Quantity::deviation, scatter, m.shares(std::vector{0.0, 0.0, 1.0}));
    const UncertaintyBudget& b = budget.budget();
    for (std::size_t i = 0; i < b.contributions.size(); ++i)
      if (b.contributions[i].id == "drift") return b.results.at(0).u.at(i);
    return -1.0;
  };
  EXPECT_NEAR(drift(100 * um, "readings"), u * std::sqrt(0.75), 1e-15);
  EXPECT_NEAR(drift(100 * um, "options.x.u_um"), u, 1e-15);  // stated: nothing of it is drift
  // Of 1.2 um of scatter, 1 um is the instrument's own: the drift cannot have made more than 0.44.
  EXPECT_NEAR(drift(1.2 * um, "readings"), std::sqrt(u * u - 0.44 * um * um), 1e-15);
}

/// Residuals contain the independent part of each reading: only the part that exceeds them is added;
/// for lines that are not among the residuals it is added completely.
TEST(Budget, WhatResidualsShowCountsOnce) {
  const Campaign c = stated();
  BudgetLine other = line(c, 1);
  other.in_residuals = false;
  const ReadingModel m = reading_model(c, c.environment, {line(c, 0), other});
  const auto u_of = [&](double scatter, const std::vector<double>& row, const std::string& source) {
    BudgetOf budget(m, scatter, 20.0, Quantity::deviation, source);
    budget.value("f", 0.0, Quantity::deviation, 0.0, m.shares(row));
    return budget.budget().results.at(0).u.at(1);  // device-fixed
  };
  const std::vector<double> of_fit{0, 0, 1, 0, 0, 0}, of_other{0, 0, 0, 0, 0, 1};
  EXPECT_NEAR(u_of(0.6 * um, of_fit, "readings"), 0.8 * um, 1e-15);
  EXPECT_NEAR(u_of(2.0 * um, of_fit, "readings"), 0.0, 1e-15);
  EXPECT_NEAR(u_of(2.0 * um, of_other, "readings"), 1.0 * um, 1e-15);
  EXPECT_NEAR(u_of(0.6 * um, of_fit, "options.x.u_um"), 1.0 * um, 1e-15);  // stated: apart
}

Observations runs(double step, double material) {
  Observations o;
  o.axes = {{"X", false, {}, {}}};
  o.lines = {{"X", {1, 0, 0}}};
  for (std::uint32_t run = 1; run <= 5; ++run)
    for (const int d : {1, -1})
      for (int i = 0; i < 6; ++i) {
        o.axes[0].position.push_back(0.1 * i);
        o.axes[0].approach.push_back(static_cast<std::int8_t>(d));
        o.deviation.push_back(step * run +
                              0.01 * um * ((i * 7 + static_cast<int>(run) * 3 + d) % 5));
        o.run.push_back(run);
        o.time.push_back(60.0 * static_cast<double>(o.time.size()));
        o.material.push_back(material);
      }
  return o;
}

TEST(Budget, TheReadingsCountWhereTheyGoBeyondWhatIsStated) {
  Campaign c = stated();
  const auto held = [&](const Observations& o) {
    const Observations* one = &o;
    return limits_held(c, {&one, 1});
  };
  const HeldLimits good = held(runs(0.0, 20.5));
  EXPECT_TRUE(good.findings.empty());
  EXPECT_EQ(good.environment.temperature_difference, 3.0);
  const HeldLimits hot = held(runs(0.0, 34.3));
  ASSERT_EQ(hot.findings.size(), 1U);
  EXPECT_EQ(hot.findings[0].id, "uncertainty.limit-exceeded");
  EXPECT_TRUE(hot.findings[0].attention);
  EXPECT_NEAR(*hot.environment.temperature_difference, 14.3, 1e-12);
  EXPECT_NEAR(*held(runs(0.0, 5.0)).environment.temperature_difference, 15.0, 1e-12);
  const HeldLimits drifted = held(runs(5 * um, 20.0));
  ASSERT_EQ(drifted.findings.size(), 1U);
  EXPECT_NEAR(*drifted.environment.drift, 20 * um, 0.1 * um);  // 5 runs
  // 59 minutes of readings; the drift test took 20.
  c.environment.drift_time = 20.0 * 60.0;
  const HeldLimits longer = held(runs(0.0, 20.0));
  ASSERT_EQ(longer.findings.size(), 1U);
  EXPECT_NEAR(*longer.environment.drift, 6 * um * 59.0 / 20.0, 1e-12);
  // Nothing is made up for what was not stated.
  c.environment = {};
  EXPECT_TRUE(held(runs(5 * um, 34.3)).findings.empty());
}

// 10 um of the instrument, 2/sqrt 3 um of misalignment, 6 and 7.2 um of temperatures, over 2 m.
TEST(Budget, WhatAllReadingsOfAScaleHaveInCommon) {
  const double U = std::sqrt(100.0 + 4.0 / 3.0 + 36.0 + 7.2 * 7.2);
  const auto u = common_scale_uncertainty(stated(), "X", 2.0);
  ASSERT_TRUE(u);
  EXPECT_NEAR(*u, U / 4.0 * um, 1e-10);
  Campaign c = stated();
  c.environment.temperature_range.reset();
  EXPECT_FALSE(common_scale_uncertainty(c, "X", 2.0));
  EXPECT_FALSE(common_scale_uncertainty(stated(), "X", 0.0));
}

}  // namespace
}  // namespace nonio::math::budget_test
