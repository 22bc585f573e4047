// SPDX-License-Identifier: Apache-2.0
// The effects of one axis, loaded as the program loads them.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

#include "campaign/config/manifest.h"
#include "campaign/loader/plugins.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::effects_test {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const Effect& effect(const std::string& name) {
  static const loader::Plugins& plugins = []() -> const loader::Plugins& {
    static loader::Plugins loaded;
    loaded.load({NONIO_TEST_PLUGINS});
    return loaded;
  }();
  for (const Effect& e : plugins.effects())
    if (e.info.name == name) return e;
  ADD_FAILURE() << "no effect " << name;
  static const Effect none;
  return none;
}

Axis linear(std::optional<double> pitch = {}) { return {.name = "X", .screw_pitch = pitch}; }
Axis rotary(std::optional<int> teeth = {}) { return {.name = "C", .rotary = true, .teeth = teeth}; }

/// One reading: position (m or rad), approach, run, time, material temperature, deviation 0.
struct Row {
  double position;
  std::int8_t approach;
  std::uint32_t run = 1;
  double time = 0.0, material = 20.0;
};

Observations table(const Axis& axis, const std::vector<Row>& rows) {
  Observations o;
  o.angular = axis.rotary;
  o.axes = {{axis.name, axis.rotary, {}, {}}};
  o.lines = {{"1", {}}};
  for (const Row& row : rows) {
    o.axes[0].position.push_back(row.position);
    o.axes[0].approach.push_back(row.approach);
    o.run.push_back(row.run);
    o.time.push_back(row.time);
    o.material.push_back(row.material);
    o.deviation.push_back(0.0);
  }
  return o;
}

/// Targets there and back, `runs` times, `step` apart, one reading in 10 s.
Observations campaign(const Axis& axis, int targets, double step, int runs) {
  std::vector<Row> rows;
  for (int run = 0; run < runs; ++run)
    for (int k = 0; k < 2 * targets; ++k) {
      const int target = k < targets ? k : 2 * targets - 1 - k;
      const double time = 10.0 * static_cast<double>(rows.size());
      rows.push_back({target * step, static_cast<std::int8_t>(k < targets ? 1 : -1),
                      static_cast<std::uint32_t>(run + 1), time, 20.0 + 1e-3 * time});
    }
  return table(axis, rows);
}

const std::vector<std::string> kinds = {
    "scale",        "pitch-curve",      "periodic",    "backlash", "backlash-slope", "zero-drift",
    "growth-drift", "warm-up",          "temperature", "run-jump", "eccentricity",   "harmonic2",
    "gear-mesh",    "elastic-reversal", "day-wave",    "zero-wave"};

/// Of several axes, of the set-up and of ball centres; space_effects_test.cpp has their columns.
const std::vector<std::string> kinds_in_space = {
    "squareness",    "straightness",      "yaw",         "pitch",     "roll",
    "line-slope",    "mirror-tilt",       "centre",      "direction", "radial-run-out",
    "axial-run-out", "linear-squareness", "linear-scale"};

const std::vector<std::string> kinds_of_channels = {
    "heat",        "heat-difference",  "heat-growth", "heat-slow",
    "heat-source", "heat-source-slow", "settling"};
const std::vector<std::string> kinds_of_circles = {"circle-centre", "servo-mismatch",
                                                   "lateral-play"};
const std::vector<std::string> descriptions = {"free-position", "free-reversal", "free-time",
                                               "free-growth"};

std::vector<double> first_shape(const Effect& e, const Observations& o, const Axis& axis) {
  std::vector<double> shape;
  for (const auto& s : e.shapes) {
    const auto grid = s.grid(o, axis);
    if (grid.empty()) return {};
    shape.push_back(grid[grid.size() / 2]);
  }
  return shape;
}

}  // namespace

struct ByHand {
  std::string kind;
  bool turns;
  std::vector<double> shape;
  std::vector<std::vector<double>> columns;
};

void PrintTo(const ByHand& c, std::ostream* out) { *out << c.kind; }

class ByHandTest : public testing::TestWithParam<ByHand> {};

// Linear: 0, 0.4, 1.0 m; p = -0.5, -0.1, 0.5; d = +, +, -; t = 0, 60, 180 s; K = -0.2, -0.1, 0.3.
// Rotary: 0, 90, 210 deg; p = -105, -15, 105 deg.
TEST_P(ByHandTest, ZeroWhereTheAxisDidNotMove) {
  const ByHand& c = GetParam();
  const Axis axis = c.turns ? rotary(6) : linear();
  const double unit = c.turns ? pi / 180.0 : 1.0;
  const std::vector<double> at =
      c.turns ? std::vector<double>{0.0, 90.0, 210.0} : std::vector<double>{0.0, 0.4, 1.0};
  const Observations o = table(axis, {{at[0] * unit, 1, 1, 100.0, 19.8},
                                      {at[1] * unit, 1, 1, 160.0, 19.9},
                                      {99.0, 0, 1, 170.0, 99.0},  // another axis moved
                                      {at[2] * unit, -1, 2, 280.0, 20.3}});
  const auto columns = effect(c.kind).columns(o, axis, c.shape);
  ASSERT_TRUE(columns) << columns.error().message;
  ASSERT_EQ(columns->size(), c.columns.size());
  EXPECT_EQ(columns->size(), effect(c.kind).linear.size());
  for (std::size_t k = 0; k < c.columns.size(); ++k) {
    ASSERT_EQ((*columns)[k].size(), 4u);
    EXPECT_NEAR((*columns)[k][0], c.columns[k][0], 1e-12);
    EXPECT_NEAR((*columns)[k][1], c.columns[k][1], 1e-12);
    EXPECT_EQ((*columns)[k][2], 0.0);
    EXPECT_NEAR((*columns)[k][3], c.columns[k][2], 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Effects, ByHandTest,
    testing::Values(
        ByHand{"scale", false, {}, {{-0.5, -0.1, 0.5}}},
        ByHand{"backlash", false, {}, {{0.5, 0.5, -0.5}}},
        ByHand{"backlash-slope", false, {}, {{-0.25, -0.05, -0.25}}},
        ByHand{"zero-drift", false, {}, {{0.0, 60.0, 180.0}}},
        ByHand{"growth-drift", false, {}, {{0.0, -6.0, 90.0}}},
        // 1 - 2^(-t/60 s) with tau = 60 s/ln 2: 0, 1/2, 7/8
        ByHand{"warm-up", false, {60.0 / std::numbers::ln2, 0.0}, {{0.0, -0.05, 0.4375}}},
        ByHand{"temperature", false, {0.0}, {{0.1, 0.01, 0.15}}},
        // The same away from the lower end.
        ByHand{"warm-up", false, {60.0 / std::numbers::ln2, -0.5}, {{0.0, 0.2, 0.875}}},
        ByHand{"temperature", false, {-0.5}, {{0.0, -0.04, 0.3}}},
        ByHand{"run-jump", false, {110.0}, {{0.0, 0.0, 1.0}}},
        // P = 1.2 m: -150, -30, 150 deg
        ByHand{"periodic",
               false,
               {1.2},
               {{-0.5, -0.5, 0.5}, {-std::sqrt(0.75), std::sqrt(0.75), -std::sqrt(0.75)}}},
        ByHand{"eccentricity", true, {}, {{0.0, 1.0, -0.5}, {1.0, 0.0, -std::sqrt(0.75)}}},
        // 0, 180, 420 deg
        ByHand{"harmonic2", true, {}, {{0.0, 0.0, std::sqrt(0.75)}, {1.0, -1.0, 0.5}}},
        // 6 teeth: 0, 540, 1260 = 180 deg
        ByHand{"gear-mesh", true, {}, {{0.0, 0.0, 0.0}, {1.0, -1.0, -1.0}}},
        ByHand{
            "elastic-reversal", true, {}, {{0.0, 0.5, 0.25}, {0.5, 0.0, std::sqrt(0.75) / 2.0}}}),
    [](const auto& c) {
      std::string name = c.param.kind;
      if (!c.param.shape.empty() && c.param.shape.back() < 0.0) name += "-from-an-end";
      for (char& letter : name)
        if (letter == '-') letter = '_';
      return name;
    });

TEST(Effects, OnlyTheAxesAndReadingsThatCanShowThemApply) {
  const auto applying = [](const Observations& o, const Axis& axis) {
    std::vector<std::string> names;
    for (const auto& kind : kinds)
      if (effect(kind).applies(o, axis)) names.push_back(kind);
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(applying(campaign(linear(), 11, 0.1, 3), linear()),
            (Names{"scale", "pitch-curve", "periodic", "backlash", "backlash-slope", "zero-drift",
                   "growth-drift", "warm-up", "temperature", "run-jump"}));
  EXPECT_EQ(applying(campaign(rotary(), 13, 0.5, 3), rotary(90)),
            (Names{"scale", "pitch-curve", "backlash", "backlash-slope", "zero-drift",
                   "growth-drift", "warm-up", "temperature", "run-jump", "eccentricity",
                   "harmonic2", "gear-mesh", "elastic-reversal"}));
  // One direction, five targets, steady temperature, no teeth.
  std::vector<Row> rows;
  for (int k = 0; k < 10; ++k)
    rows.push_back(
        {0.1 * (k % 5), 1, static_cast<std::uint32_t>(1 + k / 5), 1.0 * k, 20.0 + 0.004 * k});
  EXPECT_EQ(applying(table(linear(), rows), linear()),
            (Names{"scale", "zero-drift", "growth-drift", "warm-up", "run-jump"}));
  EXPECT_FALSE(effect("gear-mesh").applies(campaign(rotary(), 13, 0.5, 3), rotary()));
}

TEST(Effects, WhatATableCanTakeAway) {
  for (const auto& kind : kinds) {
    const bool table = kind == "scale" || kind == "pitch-curve" || kind == "periodic" ||
                       kind == "backlash" || kind == "eccentricity" || kind == "harmonic2" ||
                       kind == "gear-mesh";
    EXPECT_EQ(effect(kind).compensable, table) << kind;
  }
}

TEST(Effects, DescriptionsAreNoCandidatesAndSayEachTargetByItself) {
  const Observations o = campaign(linear(), 5, 0.1, 3);
  for (const std::string& name : descriptions) {
    const Effect& e = effect(name);
    EXPECT_TRUE(e.description && e.curve) << name;
    ASSERT_TRUE(e.applies(o, linear())) << name;
    const auto columns = e.columns(o, linear(), first_shape(e, o, linear()));
    ASSERT_TRUE(columns) << name;
    if (name == "free-time" || name == "free-growth") continue;
    // Each column is of one target.
    for (const auto& column : *columns) {
      std::set<double> at;
      for (std::size_t i = 0; i < o.size(); ++i)
        if (column[i] != 0.0) at.insert(o.axes.front().position[i]);
      EXPECT_EQ(at.size(), 1U) << name;
    }
    EXPECT_FALSE(e.applies(campaign(linear(), 4, 0.1, 3), linear())) << name;
  }
}

TEST(Effects, EveryOneHasACardInEveryLanguage) {
  for (const char* language : {"de", "en", "it"}) {
    const std::string file = std::string(NONIO_WORDS) + "/" + language + "/effects.toml";
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    const auto words = config::parse_settings(text.str(), file);
    ASSERT_TRUE(words) << words.error().message;
    std::size_t wanted = 0;
    const auto expect = [&](const std::string& name) {
      ++wanted;
      EXPECT_FALSE(words->text(name).empty()) << language << " " << name;
    };
    auto all = kinds;
    all.insert(all.end(), kinds_in_space.begin(), kinds_in_space.end());
    all.insert(all.end(), {"part-squareness", "part-straightness", "part-scale", "part-pitch-curve",
                           "part-yaw"});
    all.insert(all.end(), kinds_of_circles.begin(), kinds_of_circles.end());
    all.insert(all.end(), kinds_of_channels.begin(), kinds_of_channels.end());
    all.insert(all.end(), descriptions.begin(), descriptions.end());
    for (const auto& kind : all) {
      for (const char* part : {"title", "is", "size", "appearance", "similar", "remedy"})
        expect("effect." + kind + "." + part);
      for (const auto& p : effect(kind).linear) expect("effect." + kind + ".parameter." + p.name);
      for (const auto& s : effect(kind).shapes)
        expect("effect." + kind + ".parameter." + s.parameter.name);
    }
    EXPECT_EQ(words->values.size(), wanted) << "words for what is not there";
  }
}

TEST(Effects, GridsAscendAndGiveColumnsOfFiniteNumbers) {
  for (const auto& axis : {linear(), rotary(90)})
    for (const int targets : {8, 11, 30}) {
      const Observations o = campaign(axis, targets, 0.05, 4);
      for (const auto& kind : kinds) {
        const Effect& e = effect(kind);
        if (!e.applies(o, axis)) continue;
        for (std::size_t s = 0; s < e.shapes.size(); ++s) {
          const auto grid = e.shapes[s].grid(o, axis);
          ASSERT_FALSE(grid.empty()) << kind;
          EXPECT_LE(grid.size(), 400u) << kind;
          for (std::size_t k = 1; k < grid.size(); ++k) EXPECT_LT(grid[k - 1], grid[k]) << kind;
          for (const double value : grid) {
            auto shape = first_shape(e, o, axis);
            shape[s] = value;
            const auto columns = e.columns(o, axis, shape);
            ASSERT_TRUE(columns) << kind << ": " << columns.error().message;
            if (e.curve) {
              EXPECT_EQ(columns->size(), static_cast<std::size_t>(value));
            }
            for (const auto& column : *columns)
              for (const double v : column) ASSERT_TRUE(std::isfinite(v)) << kind;
          }
        }
      }
    }
}

// 11 targets 100 mm apart: 3 periods in 1 m, in steps of a quarter, below 5 (twice the spacing).
TEST(Effects, PeriodsOfEvenTargetsEndBelowTwiceTheSpacing) {
  const auto grid = effect("periodic").shapes[0].grid(campaign(linear(), 11, 0.1, 1), linear());
  ASSERT_EQ(grid.size(), 8u);
  EXPECT_NEAR(grid.front(), 1.0 / 4.75, 1e-12);
  EXPECT_NEAR(grid.back(), 1.0 / 3.0, 1e-12);
}

TEST(Effects, PeriodsOfUnevenTargetsGoOn) {
  std::vector<Row> rows;
  for (int k = 0; k < 11; ++k)
    rows.push_back({0.1 * k + (k % 10 == 0 ? 0.0 : 0.013 * std::sin(k)), 1});
  const auto grid = effect("periodic").shapes[0].grid(table(linear(), rows), linear());
  // 3 to 19.75 periods, and three values about each of the 15 usual leads of ball screws.
  ASSERT_EQ(grid.size(), 68u + 45u);
  EXPECT_NEAR(grid[45], 1.0 / 19.75, 1e-12);
  EXPECT_EQ(std::count(grid.begin(), grid.end(), 0.01), 1);
  for (int k = 11; k < 800; ++k) rows.push_back({1e-3 * k + 1e-4 * std::sin(k), 1});
  EXPECT_LE(effect("periodic").shapes[0].grid(table(linear(), rows), linear()).size(), 240u + 45u);
}

// A period that divides the spacing: both columns are the same at every target, which is for the
// fit to see.
TEST(Effects, AKnownPitchIsTheOnlyPeriod) {
  const Axis axis = linear(0.01);
  const Observations o = campaign(axis, 5, 0.1, 1);
  EXPECT_EQ(effect("periodic").shapes[0].grid(o, axis), std::vector<double>{0.01});
  EXPECT_TRUE(effect("periodic").applies(o, axis));
  const auto columns = effect("periodic").columns(o, axis, {0.01});
  ASSERT_TRUE(columns);
  for (const auto& column : *columns)
    for (const double v : column) EXPECT_NEAR(v, column[0], 1e-9);
}

TEST(Effects, WarmUpSearchesFromAFortiethToOneAndAHalfOfTheTest) {
  const Observations o = campaign(linear(), 5, 0.1, 3);  // 29 intervals of 10 s
  const auto grid = effect("warm-up").shapes[0].grid(o, linear());
  ASSERT_EQ(grid.size(), 14u);
  EXPECT_NEAR(grid.front(), 290.0 / 40.0, 1e-9);
  EXPECT_NEAR(grid.back(), 290.0 * 1.5, 1e-9);
}

TEST(Effects, JumpsAreTriedAtEveryEndOfAPass) {
  const Observations o = campaign(linear(), 50, 0.01, 5);  // 10 passes of 50, 500 readings
  const auto grid = effect("run-jump").shapes[0].grid(o, linear());
  EXPECT_EQ(grid.size(), 9u + 100u);
  for (int pass = 1; pass < 10; ++pass)
    EXPECT_TRUE(std::count(grid.begin(), grid.end(), 500.0 * pass - 5.0)) << pass;
}

TEST(Effects, AJumpOnACircleIsBetweenItsRuns) {
  const auto circles = [](std::uint32_t runs) {
    Observations o;
    o.lines = {{"C", {}}};
    o.axes = {{"X", false, {}, {}}, {"Y", false, {}, {}}};
    for (std::uint32_t run = 1; run <= runs; ++run)
      for (int degrees = 0; degrees < 360; degrees += 5) {
        const double at = degrees / 57.29577951308232;
        o.axes[0].position.push_back(0.15 * std::cos(at));
        o.axes[1].position.push_back(0.15 * std::sin(at));
        o.axes[0].approach.push_back(std::sin(at) > 0.0 ? -1 : 1);
        o.axes[1].approach.push_back(std::cos(at) > 0.0 ? 1 : -1);
        o.sense.push_back({std::cos(at), std::sin(at), 0.0});
        o.deviation.push_back(0.0);
        o.line.push_back(0);
        o.run.push_back(run);
        o.time.push_back(static_cast<double>(o.time.size()));
      }
    return o;
  };
  EXPECT_FALSE(effect("run-jump").applies(circles(1), linear()));
  const Observations two = circles(2);
  EXPECT_TRUE(effect("run-jump").applies(two, linear()));
  EXPECT_EQ(effect("run-jump").shapes[0].grid(two, linear()), std::vector<double>{71.5});
}

TEST(Effects, InstantsOfTwoLinesAreOnOneClock) {
  Observations o = campaign(linear(), 4, 0.1, 1);
  Observations twice = o;
  twice.lines.push_back({"2", {}});
  twice.line.assign(8, 0);
  for (std::size_t i = 0; i < 8; ++i) {
    twice.axes[0].position.push_back(o.axes[0].position[i]);
    twice.axes[0].approach.push_back(o.axes[0].approach[i]);
    twice.run.push_back(1);
    twice.time.push_back(o.time[i] + 5000.0);
    twice.material.push_back(20.0);
    twice.deviation.push_back(0.0);
    twice.line.push_back(1);
  }
  const auto& shape = effect("run-jump").shapes[0];
  EXPECT_EQ(shape.grid(twice, linear()), shape.grid(o, linear()));
}

TEST(Effects, KnotsLeaveThreeTargetsForTwoFreeValues) {
  const auto knots = [](int targets) {
    return effect("pitch-curve").shapes[0].grid(campaign(linear(), targets, 0.1, 2), linear());
  };
  using Grid = std::vector<double>;
  EXPECT_EQ(knots(5), Grid{});
  EXPECT_EQ(knots(6), Grid{3});
  EXPECT_EQ(knots(8), (Grid{3, 4}));
  EXPECT_EQ(knots(13), (Grid{3, 4, 5, 6, 7}));
  EXPECT_EQ(knots(60), (Grid{3, 4, 5, 6, 7, 8, 9, 10}));
}

TEST(Effects, AFixedPointIsTheMiddleUnlessTheReadingsOrTheManifestSayOtherwise) {
  const Observations o = campaign(linear(), 11, 0.1, 3);
  for (const char* kind : {"warm-up", "temperature"}) {
    const Effect::Shape& shape = effect(kind).shapes.back();
    ASSERT_EQ(shape.usual, 0.0) << kind;
    const auto grid = shape.grid(o, linear());
    EXPECT_EQ(std::count(grid.begin(), grid.end(), 0.0), 1) << kind;
    EXPECT_LE(grid.front(), -0.75) << kind;  // a bearing a quarter of the stretch outside
    EXPECT_GE(grid.back(), 0.75) << kind;
    EXPECT_EQ(shape.grid(campaign(rotary(), 11, 0.1, 3), rotary()), std::vector<double>{0.0});
    Axis known = linear();
    known.fixed_point = 1.2;  // the middle is 0.5
    ASSERT_EQ(shape.grid(o, known).size(), 1u) << kind;
    EXPECT_NEAR(shape.grid(o, known)[0], 0.7, 1e-12) << kind;
  }
  Axis known = linear();
  known.fixed_point = 0.0;
  const auto growth = effect("growth-drift").columns(o, known, {});
  ASSERT_TRUE(growth);
  for (std::size_t i = 0; i < o.size(); ++i)
    EXPECT_NEAR((*growth)[0][i], o.axes[0].position[i] * o.time[i], 1e-9);
}

TEST(Effects, TemperaturesThatAreMissingAreInterpolatedInTime) {
  Observations o = campaign(linear(), 11, 0.1, 3);  // 20 degC + 1 mK/s
  const auto whole = effect("temperature").columns(o, linear(), {0.0});
  for (std::size_t i = 0; i < o.size(); ++i)
    if (i % 4 != 0) o.material[i] = nan;
  std::reverse(o.time.begin(), o.time.end());  // rows need not be in the order of time
  std::reverse(o.material.begin(), o.material.end());
  ASSERT_TRUE(effect("temperature").applies(o, linear()));
  const auto r = readings_of(o, linear());
  EXPECT_EQ(r->interpolated.size(), 49u);
  // Beyond the last one that is known (65 - 1 is 64: one reading) its value holds: no more than
  // 10 mK, and as much of the mean.
  for (std::size_t i = 0; i < o.size(); ++i)
    EXPECT_NEAR(r->K[i], 1e-3 * (o.time[i] - 325.0), 0.0102) << i;
  ASSERT_TRUE(whole);
}

TEST(Effects, WhatDoesNotApplySaysWhyAndInWhichRows) {
  const auto why = [](const std::string& kind, const Observations& o) {
    const Effect& e = effect(kind);
    EXPECT_FALSE(e.applies(o, linear())) << kind;
    return e.why_not(o, linear());
  };
  Observations o = campaign(linear(), 11, 0.1, 3);
  for (std::size_t i = 20; i < 50; ++i) o.material[i] = nan;  // a gap of nearly half the test
  const WhyNot gap = why("temperature", o);
  EXPECT_EQ(gap.id, "temperature-gaps");
  ASSERT_EQ(gap.rows.size(), 30u);
  EXPECT_EQ(gap.rows.front(), 20u);
  std::fill(o.material.begin(), o.material.end(), 20.0);
  EXPECT_EQ(why("temperature", o).id, "temperature-constant");
  o.material.clear();
  EXPECT_EQ(why("temperature", o).id, "no-temperature");
  EXPECT_EQ(why("day-wave", o).id, "short-test");
  o.time.clear();
  EXPECT_EQ(why("day-wave", o).id, "no-times");
  o.order_known = false;
  for (const char* kind : {"zero-drift", "growth-drift", "warm-up", "run-jump"})
    EXPECT_EQ(why(kind, o).id, "no-order") << kind;
  std::fill(o.axes[0].approach.begin(), o.axes[0].approach.end(), std::int8_t{1});
  EXPECT_EQ(why("backlash", o).id, "one-direction");
  EXPECT_EQ(why("backlash-slope", o).id, "one-direction");
  EXPECT_EQ(why("pitch-curve", campaign(linear(), 5, 0.1, 2)).id, "few-targets");
}

// A test of ten hours: sin and 1 - cos of 15 deg an hour, from the first reading on.
TEST(Effects, ADaysWaveTurnsFifteenDegreesInAnHour) {
  Observations o = campaign(linear(), 11, 0.1, 2);
  EXPECT_FALSE(effect("day-wave").applies(o, linear()));
  for (std::size_t i = 0; i < o.size(); ++i)
    o.time[i] = 500.0 + 36000.0 * static_cast<double>(i) / 43.0;
  ASSERT_TRUE(effect("day-wave").applies(o, linear()));
  ASSERT_TRUE(effect("zero-wave").applies(o, linear()));
  const auto growth = effect("day-wave").columns(o, linear(), {0.5});
  const auto zero = effect("zero-wave").columns(o, linear(), {});
  ASSERT_TRUE(growth && zero);
  EXPECT_NEAR((*zero)[0].back(), std::sin(150.0 / 180.0 * pi), 1e-12);
  EXPECT_NEAR((*zero)[1].back(), 1.0 - std::cos(150.0 / 180.0 * pi), 1e-12);
  EXPECT_NEAR((*growth)[0].back(), -std::sin(150.0 / 180.0 * pi), 1e-12);  // 1 m from the far end
  EXPECT_NEAR((*growth)[1].front(), 0.0, 1e-12);
}

// Positions and times from another origin are the same axis. (Angles are not: theta counts.)
TEST(Effects, OriginsOfPositionAndTimeDoNotMatter) {
  const Observations o = campaign(linear(), 12, 0.05, 3);
  Observations moved = o;
  for (double& x : moved.axes[0].position) x += 2.0;
  for (double& t : moved.time) t += 1024.0;
  for (double& K : moved.material) K += 4.0;
  for (const auto& kind : kinds) {
    const Effect& e = effect(kind);
    if (!e.applies(o, linear())) continue;
    const auto shape = first_shape(e, o, linear());
    const auto one = e.columns(o, linear(), shape), other = e.columns(moved, linear(), shape);
    ASSERT_TRUE(one && other) << kind;
    for (std::size_t k = 0; k < one->size(); ++k)
      for (std::size_t i = 0; i < o.size(); ++i)
        EXPECT_NEAR((*one)[k][i], (*other)[k][i], 1e-9) << kind;
  }
}

TEST(Effects, HostileReadingsAreRefusedOrGiveFiniteColumns) {
  const Axis x = linear(), pitched = linear(0.01), c = rotary(90);
  std::vector<std::pair<Observations, Axis>> hostile;
  for (const Axis& axis : {x, pitched, c}) {
    hostile.emplace_back(Observations{}, axis);
    hostile.emplace_back(table(axis, {{0.5, 1}}), axis);
    hostile.emplace_back(table(axis, std::vector<Row>(30, Row{0.5, -1})), axis);
    hostile.emplace_back(table(axis, std::vector<Row>(30, Row{0.5, 0})), axis);
    Observations o = campaign(axis, 10, 0.1, 2);
    hostile.emplace_back(o, axis);
    hostile.back().first.time[3] = nan;
    hostile.back().first.material[7] = nan;
    hostile.emplace_back(o, axis);
    hostile.back().first.time.clear();
    hostile.back().first.material.clear();
    hostile.back().first.run.clear();
    hostile.emplace_back(o, axis);
    hostile.back().first.axes[0].approach.clear();
    hostile.emplace_back(o, axis);
    hostile.back().first.axes.clear();
    hostile.emplace_back(o, axis);
    std::reverse(hostile.back().first.time.begin(), hostile.back().first.time.end());
  }
  int refused = 0, given = 0;
  for (const auto& [o, axis] : hostile)
    for (const auto& kind : kinds) {
      const Effect& e = effect(kind);
      const bool applies = e.applies(o, axis);
      const auto shape = first_shape(e, o, axis);
      for (const auto& any : {shape, std::vector<double>{}, {nan}, {-1.0}, {1e300}, {1.0, 2.0}}) {
        const auto columns = e.columns(o, axis, any);
        refused += !columns;
        given += columns.has_value();
        if (applies && any == shape) {
          EXPECT_TRUE(columns) << kind;
        }
        if (!columns) continue;
        for (const auto& column : *columns) {
          EXPECT_EQ(column.size(), o.size()) << kind;
          for (const double v : column) EXPECT_TRUE(std::isfinite(v)) << kind;
        }
      }
    }
  EXPECT_GT(refused, 100);
  EXPECT_GT(given, 100);
}

}  // namespace nonio::effects_test
