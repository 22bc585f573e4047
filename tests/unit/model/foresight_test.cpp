// SPDX-License-Identifier: Apache-2.0
// The prediction for one more run is compared with that run, simulated.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <random>

#include "nonio/model/explain.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::model {

namespace {

constexpr double sigma = 1e-6;
constexpr int targets = 11;
using Column = std::function<double(const Observations&, std::size_t)>;

Effect linear_effect(const std::string& name, Column column) {
  Effect e;
  e.info = {name, "1", "", {}};
  e.linear = {{"a", "", Quantity::length}};
  e.columns = [column](const Observations& o, const Axis&,
                       const std::vector<double>&) -> Expected<std::vector<std::vector<double>>> {
    std::vector<double> out(o.size());
    for (std::size_t i = 0; i < o.size(); ++i) out[i] = column(o, i);
    return std::vector<std::vector<double>>{out};
  };
  return e;
}

const Effect& slope() {
  static const Effect e = linear_effect(
      "slope", [](const Observations& o, std::size_t i) { return o.axes[0].position[i]; });
  return e;
}
const Effect& reversal() {
  static const Effect e = linear_effect(
      "reversal", [](const Observations& o, std::size_t i) { return 0.5 * o.axes[0].approach[i]; });
  return e;
}
/// By the order of the readings.
const Effect& drift() {
  static const Effect e = linear_effect(
      "drift", [](const Observations&, std::size_t i) { return static_cast<double>(i) / 66.0; });
  return e;
}
/// Rises to its end with a time constant that is searched, in readings.
const Effect& warming() {
  static const Effect e = [] {
    Effect made = linear_effect("warming", {});
    Effect::Shape tau;
    tau.parameter = {"tau", "", Quantity::number};
    tau.continuous = true;
    tau.grid = [](const Observations&, const Axis&) {
      return std::vector<double>{8, 12, 18, 27, 40, 60};
    };
    made.shapes = {tau};
    made.columns =
        [](const Observations& o, const Axis&,
           const std::vector<double>& shape) -> Expected<std::vector<std::vector<double>>> {
      std::vector<double> out(o.size());
      for (std::size_t i = 0; i < o.size(); ++i)
        out[i] = 1.0 - std::exp(-static_cast<double>(i) / shape.at(0));
      return std::vector<std::vector<double>>{out};
    };
    return made;
  }();
  return e;
}

const Axis axis{.name = "X"};

/// Runs there and back; the last one as `plan` says, if it is not empty.
Part measured(int runs, const std::string& plan, std::mt19937_64& random,
              const std::vector<std::pair<const Effect*, double>>& truth, double tau = 0.0) {
  Part part;
  part.name = "X";
  part.measurements = {"X"};
  part.axes = {axis};
  Observations& o = part.table;
  o.axes = {{"X", false, {}, {}}};
  o.lines = {{"X", {1, 0, 0}}};
  const auto take = [&](int target, int from, int run) {
    o.axes[0].position.push_back(0.1 * target);
    o.axes[0].approach.push_back(static_cast<std::int8_t>(from));
    o.run.push_back(static_cast<std::uint32_t>(run));
    o.line.push_back(0);
    o.deviation.push_back(0.0);
  };
  for (int run = 1; run <= runs; ++run) {
    const bool last = run == runs;
    if (last && plan == "both-sides-at-each-target") {
      for (int k = 0; k < targets; ++k)
        for (const int from : {1, -1}) take(k, from, run);
      continue;
    }
    const int first = last && plan == "another-run-reversed" ? -1 : 1;
    for (const int from : {first, -first})
      for (int k = 0; k < targets; ++k) take(from > 0 ? k : targets - 1 - k, from, run);
  }
  std::normal_distribution<double> e(0.0, sigma);
  for (double& d : o.deviation) d = e(random);
  for (const auto& [effect, size] : truth) {
    const auto columns =
        effect->columns(o, axis, effect->shapes.empty() ? std::vector<double>{} : std::vector{tau});
    for (std::size_t i = 0; i < o.size(); ++i) o.deviation[i] += size * (*columns)[0][i];
  }
  return part;
}

const Foresight* of_plan(const std::vector<Foresight>& all, const std::string& plan) {
  for (const Foresight& one : all)
    if (one.id == plan) return &one;
  return nullptr;
}

}  // namespace

// Independent noise, no shapes: u/s follows from the design alone, to the last digits.
TEST(Foresight, UncertaintiesOfLinearEffectsAreThoseOfTheMeasuredRun) {
  std::mt19937_64 random(11);
  const std::vector<Term> model = {{&slope(), axis}, {&reversal(), axis}, {&drift(), axis}};
  const std::vector<std::pair<const Effect*, double>> truth = {
      {&slope(), 5e-6}, {&reversal(), 3e-6}, {&drift(), 2e-6}};
  const Part part = measured(3, "", random, truth);
  Explanation e;
  e.comparison = compare(part, model).value();
  ASSERT_TRUE(e.comparison.fit.noise.independent());
  const auto all = foresee(part, e);
  EXPECT_EQ(all.size(), 3u);
  std::vector<double> of_drift;
  for (const std::string plan :
       {"another-run", "another-run-reversed", "both-sides-at-each-target"}) {
    const Foresight* one = of_plan(all, plan);
    ASSERT_NE(one, nullptr) << plan;
    EXPECT_EQ(one->readings, 22u);
    ASSERT_EQ(one->parameters.size(), 3u);
    const auto then = fit(measured(4, plan, random, truth).table, model);
    ASSERT_TRUE(then) << then.error().message;
    for (std::size_t k = 0; k < 3; ++k) {
      const double wanted =
          then->parameters[k].u / then->s / (e.comparison.fit.parameters[k].u / e.comparison.fit.s);
      EXPECT_EQ(one->parameters[k].effect, then->parameters[k].effect);
      EXPECT_NEAR(one->parameters[k].factor, wanted, 1e-9) << plan << " " << k;
      EXPECT_LT(wanted, 1.0);
    }
    of_drift.push_back(one->parameters[2].factor);
  }
  EXPECT_NE(of_drift[0], of_drift[1]);
}

// The shape is an unknown of the fit: its uncertainty, and what it costs the others, are foreseen.
TEST(Foresight, UncertaintyOfASearchedShapeIsThatOfTheMeasuredRun) {
  std::mt19937_64 random(5);
  const std::vector<Term> model = {{&reversal(), axis}, {&warming(), axis}};
  const std::vector<std::pair<const Effect*, double>> truth = {{&reversal(), 3e-6},
                                                               {&warming(), 200e-6}};
  const Part part = measured(3, "", random, truth, 30.0);
  Explanation e;
  e.comparison = compare(part, model).value();
  const auto all = foresee(part, e);
  const Foresight* one = of_plan(all, "another-run");
  ASSERT_NE(one, nullptr);
  ASSERT_EQ(one->parameters.size(), 3u);
  const auto then = fit(measured(4, "another-run", random, truth, 30.0).table, model);
  ASSERT_TRUE(then) << then.error().message;
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(
        one->parameters[k].factor,
        then->parameters[k].u / then->s / (e.comparison.fit.parameters[k].u / e.comparison.fit.s),
        0.02)
        << k;
}

// 400 campaigns that are measured on: their values scatter about the truth as was foreseen.
TEST(Foresight, ValuesScatterAsForeseen) {
  constexpr std::uint64_t seed = 3;
  constexpr int campaigns = 400;
  std::mt19937_64 random(seed);
  const std::vector<Term> model = {{&slope(), axis}, {&drift(), axis}};
  const std::vector<std::pair<const Effect*, double>> truth = {{&slope(), 5e-6}, {&drift(), 2e-6}};
  double squares[2] = {};
  for (int n = 0; n < campaigns; ++n) {
    Part part = measured(4, "another-run-reversed", random, truth);
    const Part all_four = part;
    const auto cut = [](auto& column) { column.resize(66); };
    cut(part.table.deviation), cut(part.table.run), cut(part.table.line);
    cut(part.table.axes[0].position), cut(part.table.axes[0].approach);
    Explanation e;
    e.comparison.fit = fit(part.table, model).value();
    const auto all = foresee(part, e);
    const Foresight* one = of_plan(all, "another-run-reversed");
    ASSERT_NE(one, nullptr);
    const auto then = fit(all_four.table, model);
    ASSERT_TRUE(then);
    for (std::size_t k = 0; k < 2; ++k) {
      const double u = one->parameters[k].factor * e.comparison.fit.parameters[k].u;
      squares[k] += std::pow((then->parameters[k].value - truth[k].second) / u, 2);
    }
  }
  // s has 63 degrees of freedom: the mean of t^2 is 63/61; four standard deviations of the mean.
  for (const double x : squares)
    EXPECT_NEAR(x / campaigns, 63.0 / 61.0, 4.0 * std::sqrt(2.2 / campaigns)) << "seed " << seed;
}

// Evidence of a hidden drift after the run was measured, in the mean of many campaigns.
TEST(Foresight, EvidenceGrowsAsForeseen) {
  constexpr std::uint64_t seed = 17;
  constexpr int campaigns = 40;
  std::mt19937_64 random(seed);
  const std::vector<Term> model = {{&slope(), axis}},
                          catalogue = {{&drift(), axis}, {&reversal(), axis}};
  const std::vector<std::pair<const Effect*, double>> truth = {{&slope(), 5e-6}, {&drift(), 5e-6}};
  for (const std::string plan : {"another-run", "both-sides-at-each-target"}) {
    double sum = 0.0, squares = 0.0, gain = 0.0;
    for (int n = 0; n < campaigns; ++n) {
      Part part = measured(4, plan, random, truth);
      const auto then = explain(part, model, catalogue);
      const auto cut = [](auto& column) { column.resize(66); };
      cut(part.table.deviation), cut(part.table.run), cut(part.table.line);
      cut(part.table.axes[0].position), cut(part.table.axes[0].approach);
      const auto now = explain(part, model, catalogue);
      ASSERT_TRUE(now && then);
      const auto all = foresee(part, *now);
      const Foresight* one = of_plan(all, plan);
      ASSERT_NE(one, nullptr);
      ASSERT_FALSE(one->evidence.empty()) << "seed " << seed << " campaign " << n;
      EXPECT_EQ(one->evidence[0].effect, "drift:X");
      const auto found =
          std::find_if(then->candidates.begin(), then->candidates.end(),
                       [](const Candidate& c) { return c.term.name() == "drift:X"; });
      ASSERT_NE(found, then->candidates.end());
      const double miss = found->score - one->evidence[0].then;
      sum += miss, squares += miss * miss;
      gain += one->evidence[0].then - one->evidence[0].now;
    }
    const double mean = sum / campaigns,
                 sd = std::sqrt((squares / campaigns - mean * mean) / campaigns);
    std::cout << plan << ": evidence grows by " << gain / campaigns << ", foreseen too small by "
              << mean << " +- " << sd << ", seed " << seed << "\n";
    EXPECT_NEAR(mean, 0.0, 4.0 * sd);
    EXPECT_GT(gain / campaigns, 8.0 * sd) << "the test can see what it is about";
  }
}

}  // namespace nonio::model
