// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/thermal.h"

#include <gtest/gtest.h>

#include "made_heat.h"

using namespace nonio;
using namespace heat;

namespace {

/// Sensors against time, nothing turns.
Made at_rest(std::initializer_list<const char*> sensors, int n, double step,
             const std::function<double(std::size_t, double)>& d) {
  Made t;
  begin(t, "thermal");
  t.o.axes = {{"S", true, {}, {}}};
  std::size_t number = 0;
  for (const char* s : sensors) {
    t.o.lines.push_back({s, {}});
    for (int i = 0; i < n; ++i) {
      t.o.axes[0].position.push_back(0.0), t.o.axes[0].approach.push_back(0);
      t.o.time.push_back(step * i), t.o.deviation.push_back(d(number, step * i));
      t.o.line.push_back(static_cast<std::uint32_t>(number));
    }
    ++number;
  }
  return t;
}

/// An axis that grows from a fixed point, read at both ends from both sides.
Made exercised(double w, double tau, double fixed, double noise, int cycles, Random& r) {
  Made t;
  begin(t, "thermal");
  t.campaign.measurements[0].axis = "X";
  Axis x;
  x.name = "X";
  t.campaign.machine.axes = {x};
  t.o.axes = {{"X", false, {}, {}}};
  t.o.lines = {{"M", {1.0, 0.0, 0.0}}};
  std::normal_distribution<double> N;
  double time = 0.0;
  for (int c = 1; c <= cycles; ++c)
    for (const int direction : {1, -1})
      for (const double place : {direction > 0 ? 0.1 : 0.9, direction > 0 ? 0.9 : 0.1}) {
        t.o.axes[0].position.push_back(place),
            t.o.axes[0].approach.push_back(direction > 0 ? 1 : -1);
        t.o.time.push_back(time), t.o.run.push_back(static_cast<std::uint32_t>(c));
        t.o.deviation.push_back(w * (place - fixed) * (1.0 - std::exp(-time / tau)) +
                                direction * 1e-6 + noise * N(r));
        time += 15.0;
      }
  return t;
}

}  // namespace

// bench/heat.cpp does 2,000 of them; this is a small part of it.
TEST(Thermal, UHoldsTheTruthOfBodiesThatWarm) {
  constexpr std::uint64_t seed = 20261125;
  SCOPED_TRACE("seed " + std::to_string(seed));
  int within = 0, all = 0;
  for (const auto& [name, c] : thermal_coverage(60, seed)) {
    if (name == "not one constant") continue;
    EXPECT_GT(c.all, 40) << name;
    within += c.within, all += c.all;
  }
  EXPECT_GE(within, all * 88 / 100) << "of " << all;
  EXPECT_LT(within, all) << "U is too large to be one";
}

TEST(Thermal, AMachineAtRestHasRangesAndProposesADrift) {
  Made t = at_rest({"X", "Y"}, 145, 300.0, [](std::size_t sensor, double time) {
    return (sensor == 0 ? 1.0 : 4.0) * 1e-6 * std::sin(2.0 * std::numbers::pi * time / 43200.0);
  });
  const auto e = evaluated(thermal(), t);
  ASSERT_NE(value(e, "range_Y"), nullptr);
  EXPECT_NEAR(value(e, "range_Y")->value, 8e-6, 1e-9);
  // An hour about the steepest place: 2 * 4 * sin(2 pi/24).
  EXPECT_NEAR(value(e, "window_Y")->value, 8e-6 * std::sin(std::numbers::pi / 12.0), 1e-9);
  EXPECT_EQ(value(e, "tau_Y"), nullptr);
  const Finding* f = finding(e, "thermal.drift-proposal");
  ASSERT_NE(f, nullptr);
  EXPECT_NEAR(evidence(*f, "drift"), value(e, "window_Y")->value, 1e-15);
  EXPECT_NEAR(evidence(*f, "U_EVE"), 0.6 * value(e, "window_Y")->value, 1e-15);
  t.campaign.environment.drift = 1e-6;  // states less
  const auto stated = evaluated(thermal(), t);
  const Finding* above = finding(stated, "thermal.drift-above-stated");
  ASSERT_NE(above, nullptr);
  EXPECT_TRUE(above->attention);
  EXPECT_EQ(evidence(*above, "stated"), 1e-6);
  EXPECT_EQ(t.campaign.environment.drift, 1e-6) << "a proposal changes nothing";
  t.o.channels = {
      {.name = "spindle", .unit = "rpm", .time = {0.0, 1000.0}, .value = {0.0, 6000.0}}};
  const auto loaded = evaluated(thermal(), t);
  EXPECT_EQ(finding(loaded, "thermal.drift-above-stated"), nullptr) << "it was not at rest";
  EXPECT_EQ(loaded.notes.back().id, "method.thermal-loaded");
}

TEST(Thermal, ASensorThatWasTouchedProposesNoDrift) {
  const Made t = at_rest({"X", "Y"}, 145, 300.0, [](std::size_t sensor, double time) {
    const double slow = 1e-6 * std::sin(2.0 * std::numbers::pi * time / 43200.0);
    return slow + (sensor == 1 && time > 20000.0 ? 9e-6 : 0.0);
  });
  const auto e = evaluated(thermal(), t);
  const Finding* f = finding(e, "thermal.jump");
  ASSERT_NE(f, nullptr);
  EXPECT_NEAR(evidence(*f, "jump"), 9e-6, 0.2e-6);
  EXPECT_EQ(value(e, "window_Y"), nullptr);
  const Finding* proposal = finding(e, "thermal.drift-proposal");
  ASSERT_NE(proposal, nullptr);
  EXPECT_EQ(evidence(*proposal, "drift"), value(e, "window_X")->value);
}

TEST(Thermal, ATiltOfATouchedSensorHasNoRange) {
  Made t = at_rest({"X1", "X2"}, 145, 300.0, [](std::size_t sensor, double time) {
    const double slow = 1e-6 * std::sin(2.0 * std::numbers::pi * time / 43200.0);
    return slow + (sensor == 1 && time > 20000.0 ? 9e-6 : 0.0);
  });
  t.campaign.measurements[0].foot = 0.1;
  const auto e = evaluated(thermal(), t);
  EXPECT_EQ(value(e, "range_B"), nullptr);
  std::size_t jumps = 0;
  for (const Finding& f : e.findings) jumps += f.id == "thermal.jump" ? 1U : 0U;
  EXPECT_EQ(jumps, 1U);
}

TEST(Thermal, APauseIsNoJump) {
  Made t = at_rest({"X"}, 145, 120.0, [](std::size_t, double time) {
    return 0.6e-9 * (time > 7200.0 ? time + 4000.0 : time);  // 2.2 um/h
  });
  for (double& time : t.o.time)
    if (time > 7200.0) time += 4000.0;
  const auto e = evaluated(thermal(), t);
  EXPECT_EQ(finding(e, "thermal.jump"), nullptr);
  ASSERT_NE(value(e, "window_X"), nullptr);
}

TEST(Thermal, ShiftTurnAndOrderOfRowsChangeNothing) {
  Random r(11);
  const MadeSpindle m = warming(r, 0.1e-6, 0.0);
  const auto one = evaluated(thermal(), m.test);
  Made shifted = m.test;
  for (double& d : shifted.o.deviation) d += 0.125;
  for (double& s : shifted.o.time) s += 1024.0;
  std::vector<std::uint32_t> back(m.test.o.size());
  for (std::uint32_t i = 0; i < back.size(); ++i)
    back[i] = static_cast<std::uint32_t>(back.size() - 1 - i);
  shifted.o = rearranged(shifted.o, back);
  const auto two = evaluated(thermal(), shifted);
  ASSERT_EQ(one.values.size(), two.values.size());
  for (std::size_t i = 0; i < one.values.size(); ++i)
    EXPECT_NEAR(one.values[i].value, two.values[i].value,
                1e-6 * std::fabs(one.values[i].value) + 1e-13)
        << one.values[i].name;
  Made mirrored = m.test;
  for (double& d : mirrored.o.deviation) d = -d;
  const auto three = evaluated(thermal(), mirrored);
  EXPECT_NEAR(value(three, "end_Z")->value, -value(one, "end_Z")->value, 1e-15);
  EXPECT_NEAR(value(three, "range_Z")->value, value(one, "range_Z")->value, 1e-15);
  EXPECT_NEAR(value(three, "tau_Z")->value, value(one, "tau_Z")->value, 1.0);
}

TEST(Thermal, ATestOfLessThanTwoTimeConstantsIsRefusedByName) {
  Random r(3);
  for (int i = 0; i < 8; ++i) {
    const MadeSpindle m = warming(r, 0.1e-6, 0.0, 20, 60.0);  // 19 min; tau is 14 min at least
    const auto e = evaluated(thermal(), m.test);
    EXPECT_EQ(value(e, "tau_Z"), nullptr);
    EXPECT_EQ(finding(e, "thermal.warm-up-time"), nullptr);
    EXPECT_TRUE(finding(e, "thermal.test-too-short") != nullptr ||
                finding(e, "thermal.unresolved") != nullptr);
    EXPECT_NE(finding(e, "thermal.window-longer"), nullptr);
    EXPECT_NE(value(e, "range_Z"), nullptr);
  }
}

TEST(Thermal, ASpindleIsCutWhereItStartsAndStops) {
  Random r(5);
  MadeSpindle m = warming(r, 1e-9, 0.0);
  auto& o = m.test.o;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (i < 10 || i >= 200) o.axes[0].approach[i] = 0;
  for (std::size_t i = 0; i < 10; ++i) o.deviation[i] = o.deviation[10];
  const double stop = o.deviation[200];
  for (std::size_t i = 201; i < o.size(); ++i) o.deviation[i] = stop;
  const auto e = evaluated(thermal(), m.test);
  EXPECT_NEAR(value(e, "end_Z")->value, o.deviation[200] - o.deviation[10], 1e-12);
  EXPECT_NEAR(value(e, "cool_Z")->value, 0.0, 1e-12);
  for (std::size_t i = 201; i < o.size(); ++i) o.deviation[i] = stop - 3e-6;
  EXPECT_NEAR(value(evaluated(thermal(), m.test), "cool_Z")->value, -3e-6, 1e-12);
  for (std::size_t i = 100; i < o.size(); ++i)
    o.axes[0].position[i] *= 1.0 + 0.001 * static_cast<double>(i);
  const auto steps = evaluated(thermal(), m.test);
  EXPECT_NE(finding(steps, "thermal.speed-steps"), nullptr);
  EXPECT_EQ(value(steps, "tau_Z"), nullptr);
}

TEST(Thermal, TiltIsTheDifferenceOverTheDistance) {
  Made t = at_rest({"X1", "X2"}, 61, 120.0, [](std::size_t sensor, double time) {
    return (sensor == 0 ? 6e-6 : 2e-6) * time / 7200.0;
  });
  EXPECT_NE(finding(evaluated(thermal(), t), "thermal.no-tilt"), nullptr);
  t.campaign.measurements[0].foot = 0.1;
  const auto e = evaluated(thermal(), t);
  ASSERT_NE(value(e, "range_B"), nullptr);
  EXPECT_NEAR(value(e, "range_B")->value, 4e-6 / 0.1, 1e-12);
  EXPECT_EQ(value(e, "range_B")->quantity, Quantity::small_angle);
}

TEST(Thermal, AnAxisThatGrowsProposesTheEffectOfTheModel) {
  Random r(9);
  const Made t = exercised(40e-6, 1500.0, 0.25, 0.05e-6, 240, r);
  const auto e = evaluated(thermal(), t);
  ASSERT_NE(value(e, "tau_X"), nullptr);
  EXPECT_NEAR(value(e, "tau_X")->value, 1500.0, *value(e, "tau_X")->U * 1.5);
  // The first cycle is 0: at 22.5 s in the mean.
  EXPECT_NEAR(value(e, "growth_X")->value, 40e-6 * std::exp(-22.5 / 1500.0), 0.3e-6);
  EXPECT_NEAR(value(e, "end_X")->value, 40e-6 * 0.65 * std::exp(-15.0 / 1500.0), 0.25e-6);
  EXPECT_NEAR(value(e, "c_X")->value, 40e-6, 0.25e-6) << "from the start, not from the first cycle";
  const Finding* f = finding(e, "thermal.for-the-model");
  ASSERT_NE(f, nullptr);
  EXPECT_NEAR(evidence(*f, "w"), 40e-6, 0.25e-6);
  EXPECT_NEAR(evidence(*f, "fixed"), 0.25, 0.01);
  EXPECT_NEAR(value(e, "reversal_X")->value, 0.0, 1e-6);
}

TEST(Thermal, TheWarmUpLastsUntilTheTargetThatMovesMostIsSettled) {
  Random r(10);
  // The fixed point is outside of the travel: the target at 0.1 m moves by 55 um.
  const auto e = evaluated(thermal(), exercised(50e-6, 1800.0, 1.2, 0.05e-6, 240, r));
  const Finding* f = finding(e, "thermal.warm-up-time");
  ASSERT_NE(f, nullptr);
  EXPECT_NEAR(evidence(*f, "time_min"), 1800.0 * std::log(55.0) / 60.0, 1.5);
  const auto middle = evaluated(thermal(), exercised(50e-6, 1800.0, 0.5, 0.05e-6, 240, r));
  f = finding(middle, "thermal.warm-up-time");
  ASSERT_NE(f, nullptr);
  EXPECT_NEAR(evidence(*f, "time_min"), 1800.0 * std::log(20.0) / 60.0, 1.5);
}

TEST(Thermal, OfOneTargetThereIsNoGrowth) {
  Random r(2);
  Made t = exercised(40e-6, 1500.0, 0.25, 0.05e-6, 30, r);
  for (double& p : t.o.axes[0].position) p = 0.1;
  const auto e = evaluated(thermal(), t);
  EXPECT_EQ(value(e, "growth_X"), nullptr);
  EXPECT_NE(finding(e, "thermal.one-target"), nullptr);
}

TEST(Thermal, ADeadSensorHasNoValues) {
  const auto e =
      evaluated(thermal(), at_rest({"X", "Y"}, 145, 300.0, [](std::size_t sensor, double t) {
                  return sensor == 0 ? 1e-6 : 1e-6 * std::sin(t / 5000.0);
                }));
  EXPECT_EQ(value(e, "range_X"), nullptr);
  EXPECT_NE(value(e, "range_Y"), nullptr);
  EXPECT_NE(finding(e, "sensor.refused-equal"), nullptr);
}

TEST(Thermal, HostileReadingsAreNoCrashAndNoNumber) {
  Made t = at_rest({"X"}, 30, 60.0, [](std::size_t, double) { return 0.0; });
  for (const double d : {0.0, -1e20, 1e300}) {
    t.o.deviation.assign(t.o.size(), d);
    for (const Value& v : evaluated(thermal(), t).values) EXPECT_TRUE(std::isfinite(v.value)) << d;
  }
  t.o = rearranged(t.o, {});
  EXPECT_TRUE(evaluated(thermal(), t).values.empty());
  t = at_rest({"X"}, 1, 60.0, [](std::size_t, double) { return 1e-6; });
  EXPECT_TRUE(evaluated(thermal(), t).values.empty());
  t.o.time.clear();
  EXPECT_FALSE(thermal().analyse({t.campaign, t.campaign.measurements[0], t.o, {}}));
}

TEST(Thermal, WithoutTheInstrumentsUThereIsNoU) {
  Random r(4);
  MadeSpindle m = warming(r, 0.1e-6, 0.0);
  m.test.campaign.instrument.U_fixed.reset();
  const auto e = evaluated(thermal(), m.test);
  EXPECT_NE(finding(e, "uncertainty.no-data"), nullptr);
  for (const Value& v : e.values) EXPECT_FALSE(v.U) << v.name;
  EXPECT_FALSE(e.budget);
}
