// SPDX-License-Identifier: Apache-2.0
//
// The three plugins on what a screw, a sticking guide and a bending column make.
#include "nonio/math/fine_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "loaded_analysis.h"
#include "nonio/sdk/plugin.h"

namespace nonio::fixtures::fine_motion_test {
namespace {

constexpr double um = 1e-6, mm = 1e-3;

struct Made {
  Campaign campaign;
  std::vector<Observations> all;
};

Made made(const char* axis = "X") {
  Made out;
  out.campaign.machine.axes = {Axis{.name = axis, .screw_pitch = 10.0 * mm}};
  out.campaign.instrument.U_fixed = 0.05 * um, out.campaign.instrument.U_per_length = 0.5e-6;
  out.campaign.environment.drift = 0.2 * um;
  return out;
}

Observations& add(Made& m, const std::string& id) {
  Measurement one;
  one.id = id, one.kind = "axis", one.axis = "X", one.file = id + ".csv";
  m.campaign.measurements.push_back(one);
  Observations& o = m.all.emplace_back();
  o.measurement = id;
  o.axes = {{"X", false, {}, {}}};
  return o;
}

void read(Observations& o, double target, int direction, std::uint32_t run, double deviation) {
  o.axes.front().position.push_back(target);
  o.axes.front().approach.push_back(static_cast<std::int8_t>(direction));
  o.run.push_back(run), o.deviation.push_back(deviation);
}

Evaluation evaluated(const Analysis& a, const Made& m, std::size_t which = 0,
                     std::map<std::string, Setting, std::less<>> changed = {}) {
  Settings settings;
  for (const Option& o : a.info.options) settings.values[o.name] = o.default_value;
  for (auto& [name, value] : changed) settings.values[name] = value;
  auto out =
      a.analyse({m.campaign, m.campaign.measurements[which], m.all[which], settings, &m.all});
  if (!out) ADD_FAILURE() << out.error().message;
  return out ? *out : Evaluation{};
}

const Value* value(const Evaluation& e, const std::string& name) {
  for (const Value& v : e.values)
    if (v.name == name) return &v;
  return nullptr;
}
double number(const Evaluation& e, const std::string& name) {
  const Value* v = value(e, name);
  return v != nullptr ? v->value : NAN;
}
const Finding* finding(const Evaluation& e, const std::string& id) {
  for (const Finding& f : e.findings)
    if (f.id == id) return &f;
  return nullptr;
}

const Analysis& periodic() {
  static const Analysis a = loaded_analysis(NONIO_ANALYSES, "periodic-error");
  return a;
}
const Analysis& steps() {
  static const Analysis a = loaded_analysis(NONIO_ANALYSES, "small-steps");
  return a;
}
const Analysis& worst() {
  static const Analysis a = loaded_analysis(NONIO_ANALYSES, "worst-line");
  return a;
}

/// A crank behind a screw: the error of its angle is geometry, no sum of waves of the analysis.
/// The bearing's axis is off by e and the encoder reads about its own.
double crank(double x, double pitch, double e, double shift) {
  const double t = 2.0 * std::numbers::pi * (x / pitch + shift);
  const double off = std::atan2(e * std::sin(t), 1.0 + e * std::cos(t));
  return pitch * off / (2.0 * std::numbers::pi);
}

struct Truth {
  double range = 0.0, first = 0.0, second = 0.0;
};

/// By a fine quadrature of the exact curve at the phases that are read.
Truth truth_of(double pitch, double e, double shift) {
  Truth out;
  constexpr int n = 4000;
  double c[2] = {}, s[2] = {}, low = INFINITY, high = -INFINITY;
  for (int i = 0; i < n; ++i) {
    const double d = crank(pitch * i / n, pitch, e, shift);
    if (i % (n / 20) == 0) low = std::min(low, d), high = std::max(high, d);
    for (int k = 0; k < 2; ++k) {
      c[k] += 2.0 / n * d * std::cos(2.0 * std::numbers::pi * (k + 1) * i / n);
      s[k] += 2.0 / n * d * std::sin(2.0 * std::numbers::pi * (k + 1) * i / n);
    }
  }
  out.range = high - low;
  out.first = 2.0 * std::hypot(c[0], s[0]), out.second = 2.0 * std::hypot(c[1], s[1]);
  return out;
}

}  // namespace

TEST(PeriodicError, UHoldsAnEccentricDrive) {
  constexpr unsigned seed = 20261126;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> N;
  std::uniform_real_distribution<double> U;
  constexpr int count = 200;
  int range = 0, first = 0, second = 0;
  for (int i = 0; i < count; ++i) {
    Made m = made();
    Observations& o = add(m, "X");
    const double e = 1e-4 + 2e-3 * U(random), shift = U(random), slope = 20e-6 * N(random),
                 noise = (0.02 + 0.1 * U(random)) * um;
    // As the certificate has it: U_fixed is reached at the largest deviation.
    const double gain = 1.0 + 0.025 * um * N(random) / (10.0 * mm * e / (2.0 * std::numbers::pi));
    for (int k = 0; k <= 60; ++k) {
      const double x = 0.2 + 0.5 * mm * k;
      read(o, x, 1, 1,
           gain * (crank(x, 10.0 * mm, e, shift) + slope * (x - 0.2)) + noise * N(random));
    }
    const Truth t = truth_of(10.0 * mm, e, shift);
    const Evaluation r = evaluated(periodic(), m);
    const auto holds = [&](const char* name, double true_value) {
      const Value* v = value(r, name);
      return v != nullptr && v->U && std::fabs(v->value - true_value) <= *v->U;
    };
    range += holds("periodic+", t.range), first += holds("periodic_2c1+", t.first);
    second += holds("periodic_2c2+", t.second);
  }
  EXPECT_GE(first, count * 90 / 100);
  EXPECT_GE(second, count * 90 / 100);
  EXPECT_GE(range, count * 90 / 100);
  std::printf("seed %u: range %d, 2c1 %d, 2c2 %d of %d within U\n", seed, range, first, second,
              count);
}

TEST(PeriodicError, ALineIsNoWaveAndEachDirectionIsItsOwn) {
  Made m = made();
  Observations& o = add(m, "X");
  for (int k = 0; k <= 40; ++k) {
    const double x = 0.1 + 0.5 * mm * k, t = 2.0 * std::numbers::pi * x / (10.0 * mm);
    read(o, x, 1, 1, 100e-6 * x + 3.0 * um * std::cos(t - 1.0));
    read(o, x, -1, 1, 100e-6 * x - 5.0 * um + 1.0 * um * std::cos(2.0 * t - 0.5));
  }
  const Evaluation e = evaluated(periodic(), m);
  EXPECT_NEAR(number(e, "periodic_2c1+"), 6.0 * um, 1e-12);
  EXPECT_NEAR(number(e, "periodic_2c2+"), 0.0, 1e-12);
  EXPECT_NEAR(number(e, "periodic_2c1-"), 0.0, 1e-12);
  EXPECT_NEAR(number(e, "periodic_2c2-"), 2.0 * um, 1e-12);
  EXPECT_NEAR(number(e, "periodic_at1+"), 10.0 * mm / (2.0 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(number(e, "periodic_at2-"), 0.5 * 10.0 * mm / (4.0 * std::numbers::pi), 1e-9);
  // Twenty phases of a cosine: the largest and the least are within half a step of the extremes.
  EXPECT_LE(number(e, "periodic+"), 6.0 * um);
  EXPECT_GE(number(e, "periodic+"), 6.0 * um * std::cos(std::numbers::pi / 20.0));
}

TEST(PeriodicError, RefusesWhatDoesNotShowAPeriod) {
  Made m = made();
  Observations& o = add(m, "X");
  for (int k = 0; k < 40; ++k) read(o, 0.5 * mm * k, 1, 1, 0.0);  // 19.5 mm
  EXPECT_NE(finding(evaluated(periodic(), m), "periodic-error.too-short"), nullptr);
  EXPECT_TRUE(evaluated(periodic(), m).values.empty());
  read(o, 20.0 * mm, 1, 1, 0.0);
  EXPECT_EQ(finding(evaluated(periodic(), m), "periodic-error.too-short"), nullptr);
  EXPECT_NE(finding(evaluated(periodic(), m, 0, {{"period_mm", 9.0}}), "periodic-error.too-coarse"),
            nullptr);
  m.campaign.machine.axes.front().screw_pitch.reset();
  EXPECT_NE(finding(evaluated(periodic(), m), "periodic-error.no-period"), nullptr);
}

TEST(PeriodicError, OneMissingReadingMakesItTooCoarse) {
  Made m = made();
  Observations& o = add(m, "X");
  for (int k = 0; k <= 60; ++k)
    if (k != 30) read(o, 0.5 * mm * k, 1, 1, 0.0);
  EXPECT_NE(finding(evaluated(periodic(), m), "periodic-error.too-coarse"), nullptr);
}

TEST(PeriodicError, MoreRunsGiveASmallerU) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> N;
  const auto of = [&](int runs) {
    Made m = made();
    m.campaign.instrument.U_fixed = 0.0;
    Observations& o = add(m, "X");
    for (int run = 1; run <= runs; ++run)
      for (int k = 0; k <= 60; ++k)
        read(o, 0.5 * mm * k, 1, static_cast<std::uint32_t>(run),
             um * std::cos(2.0 * std::numbers::pi * k / 20.0) + 0.2 * um * N(random));
    return *value(evaluated(periodic(), m), "periodic_2c1+")->U;
  };
  const double one = of(1), sixteen = of(16);
  EXPECT_LT(sixteen, 0.5 * one);
  EXPECT_GT(sixteen, 0.12 * one);
}

namespace {

/// A table on a spring: it follows when the spring pulls more than what sticks.
void walk(Observations& o, int runs, double stick, double rest, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> N;
  for (int run = 1; run <= runs; ++run) {
    double at = 0.0;
    const auto go = [&](int k, int direction) {
      const double command = um * k;
      if (std::fabs(command - at) > stick) at = command - direction * rest;
      read(o, 0.3 + command, direction, static_cast<std::uint32_t>(run),
           at - command + noise * N(random));
    };
    for (int k = 0; k <= 10; ++k) go(k, 1);
    for (int k = 9; k >= 0; --k) go(k, -1);
  }
}

}  // namespace

TEST(SmallSteps, AReversalTakesTheFirstStepOnly) {
  Made m = made();
  walk(add(m, "X"), 3, 0.7 * um, 0.35 * um, 0.0, 1);
  const Evaluation e = evaluated(steps(), m);
  EXPECT_NEAR(number(e, "step_error_reversal"), -1.0 * um, 1e-12);
  EXPECT_NEAR(number(e, "step_error_min"), -0.35 * um, 1e-12);  // from rest
  EXPECT_NEAR(number(e, "step_error_max"), 0.3 * um, 1e-12);    // the lost step is made up for
  EXPECT_EQ(finding(e, "small-steps.not-followed"), nullptr);
}

TEST(SmallSteps, StickingStepsAreCounted) {
  Made m = made();
  walk(add(m, "X"), 3, 1.5 * um, 0.0, 0.0, 1);  // every other step is followed, by two at once
  const Evaluation e = evaluated(steps(), m);
  const Finding* f = finding(e, "small-steps.not-followed");
  ASSERT_NE(f, nullptr);
  EXPECT_TRUE(f->attention);
  EXPECT_EQ(f->evidence.front().value, 3 * (5 + 4));
  EXPECT_NEAR(number(e, "step_error_max"), 1.0 * um, 1e-12);
}

TEST(SmallSteps, StepsOfOneSizeOnly) {
  Made m = made();
  Observations& o = add(m, "X");
  for (const int k : {0, 1, 2, 4}) read(o, um * k, 1, 1, 0.0);
  const Evaluation e = evaluated(steps(), m);
  EXPECT_NE(finding(e, "small-steps.several-sizes"), nullptr);
  EXPECT_TRUE(e.values.empty());
}

TEST(SmallSteps, OneRunHasNoU) {
  Made m = made();
  walk(add(m, "X"), 1, 0.7 * um, 0.35 * um, 0.01 * um, 1);
  const Evaluation e = evaluated(steps(), m);
  EXPECT_NE(finding(e, "small-steps.no-repeats"), nullptr);
  EXPECT_FALSE(value(e, "step_error_min")->U);
}

TEST(SmallSteps, BetweenRunsThereIsNoStep) {
  Made m = made();
  Observations& o = add(m, "X");
  for (const std::uint32_t run : {1U, 2U})
    for (int k = 0; k <= 3; ++k) read(o, um * k, 1, run, run == 1 ? 0.0 : 50.0 * um);
  EXPECT_NEAR(number(evaluated(steps(), m), "step_error_max"), 0.0, 1e-12);
}

namespace {

void pass(Made& m, const std::string& id, double slope, double scatter) {
  Observations& o = add(m, id);
  for (std::uint32_t run = 1; run <= 5; ++run)
    for (const int direction : {1, -1})
      for (int i = 0; i < 5; ++i) {
        const double x = 0.1 * i;
        read(o, x, direction, run, slope * x + (direction < 0 ? -um : 0.0) + scatter * (run - 3.0));
      }
}

}  // namespace

TEST(WorstLine, EachValueIsThatOfItsWorstLine) {
  Made m = made();
  pass(m, "steep", 20e-6, 0.1 * um), pass(m, "scattered", 2e-6, um);
  const Evaluation e = evaluated(worst(), m);
  EXPECT_NEAR(number(e, "E_worst"), 8.0 * um + um, 1e-12);
  const double s = um * std::sqrt(2.5);
  EXPECT_NEAR(number(e, "R_worst"), std::max(4.0 * s, 4.0 * s + um), 1e-12);
  EXPECT_EQ(e.uses, std::vector<std::string>{"scattered"});
  for (const Finding& f : e.findings)
    if (f.id == "worst-line.which" && f.texts.front().second == "E")
      EXPECT_EQ(f.texts.back().second, "steep");
  // Only the first line has these values.
  EXPECT_TRUE(evaluated(worst(), m, 1).values.empty());
}

TEST(WorstLine, WhatOneLineDoesNotGiveIsNotGiven) {
  Made m = made();
  pass(m, "whole", 20e-6, um);
  Observations& o = add(m, "one-way");
  for (int i = 0; i < 5; ++i) read(o, 0.1 * i, 1, 1, 50.0 * um * i);
  const Evaluation e = evaluated(worst(), m);
  EXPECT_TRUE(e.values.empty());
  EXPECT_NE(finding(e, "worst-line.absent"), nullptr);
}

TEST(WorstLine, OneLineIsSaid) {
  Made m = made();
  pass(m, "only", 1e-6, um);
  const Evaluation e = evaluated(worst(), m);
  const Finding* f = finding(e, "worst-line.one-line");
  ASSERT_NE(f, nullptr);
  EXPECT_TRUE(f->attention);
}

}  // namespace nonio::fixtures::fine_motion_test
