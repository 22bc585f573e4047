// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "workshop.h"

namespace rotary_test {

using namespace workshop;

namespace {

struct Kind {
  const char* name;
  Controller (*output)();
  Options options;
  double resolution;  // of the table, rad
};

std::vector<Kind> kinds() {
  const Setting fine = 0.36;  // a detection unit of 0.0001 deg
  return {
      {"siemens-840d", siemens_plugin, {}, 0.01 * arcsec},
      {"heidenhain-tnc", heidenhain_plugin, {}, 0.36 * arcsec},
      {"heidenhain-tnc", heidenhain_plugin, {{"layout", std::string("itnc530")}}, 0.36 * arcsec},
      {"fanuc", fanuc_plugin, {{"extended", true}, {"detection_unit_arcsec", fine}}, 0.36 * arcsec},
      {"linuxcnc", linuxcnc_plugin, {}, 1e-3 * arcsec}};
}

// Sines of the turn and its double: closes by itself.
Measured table_axis(std::mt19937& random, std::vector<double> targets) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const double a = 8 * arcsec * u(random), b = 3 * arcsec * u(random), p = 3 * u(random);
  Measured m;
  m.axis = m.id = "C";
  m.rotary = true;
  m.targets = std::move(targets);
  m.plus = [=](double x) { return 4 * arcsec + a * std::sin(x + p) + b * std::cos(2 * x + p); };
  m.minus = [e = m.plus](double x) { return e(x) + 5 * arcsec; };
  return m;
}

}  // namespace

TEST(Rotary, AWholeTurnThatDoesNotBeginAtTheReferenceIsRefusedByName) {
  std::mt19937 random(1);
  Bench b(table_axis(random, even(0.0, 30 * deg, 13)));
  const Options options = {{"extended", true},
                           {"axes", NumberTables{{"C", {{"reference_deg", 120.0}}}}}};
  const auto r = b.write(fanuc_plugin(), options);
  ASSERT_FALSE(r);
  EXPECT_TRUE(contains(r.error().message, "reference_deg is 120")) << r.error().message;
}

TEST(Rotary, ATableThatDoesNotRepeatSaysWhatHoldsBeyondTheTurn) {
  std::mt19937 random(1);
  const auto r =
      Bench(table_axis(random, even(0.0, 30 * deg, 13))).write(linuxcnc_plugin(), Options{});
  ASSERT_TRUE(r) << r.error().message;
  for (const Artifact& f : r->artifacts)
    EXPECT_FALSE(contains(f.bytes, "repeats after each turn")) << f.name;
}

TEST(Rotary, TurnsOfAnyStartAreCompensated) {
  const std::uint32_t seed = 360;
  print_seed(seed);
  for (const Kind& k : kinds()) {
    std::mt19937 random(seed);
    for (const double first : {0.0, -180.0, 5.0, -90.0})
      for (const int n : {12, 13}) {  // with and without the end that is the beginning
        const auto m = table_axis(random, even(first * deg, 30 * deg, n));
        const auto r = Bench(m).write(k.output(), k.options);
        ASSERT_TRUE(r) << k.name << ", from " << first << ": " << r.error().message;
        const double E = prediction(*r, "E").after;
        EXPECT_LE(E, 2.5 * k.resolution + 0.01 * arcsec) << k.name << ", from " << first;
        EXPECT_EQ(prediction(*r, "E").quantity, Quantity::angular_deviation);
      }
  }
}

TEST(Rotary, UnevenTargetsOverTheTurn) {
  const std::uint32_t seed = 361;
  print_seed(seed);
  for (const Kind& k : kinds()) {
    std::mt19937 random(seed);
    std::vector<double> targets;
    std::uniform_real_distribution<double> u(-4.0, 4.0);
    for (int i = 0; i < 18; ++i)
      targets.push_back((20.0 * i + std::round(u(random) * 100) / 100) * deg);
    const auto m = table_axis(random, targets);
    const auto r = Bench(m).write(k.output(), k.options);
    ASSERT_TRUE(r) << k.name << ": " << r.error().message;
    EXPECT_LT(prediction(*r, "E").after, 0.15 * prediction(*r, "E").before + 2.5 * k.resolution)
        << k.name;
  }
}

// A tilting axis has two ends: no table may repeat itself behind them.
TEST(Rotary, AnArcIsNotATurn) {
  std::mt19937 random(3);
  const auto m = table_axis(random, even(-100 * deg, 10 * deg, 14));
  for (const Kind& k : kinds()) {
    const auto r = Bench(m).write(k.output(), k.options);
    ASSERT_TRUE(r) << k.name << ": " << r.error().message;
    EXPECT_LE(prediction(*r, "E").after, 2.5 * k.resolution + 0.01 * arcsec) << k.name;
    for (const Artifact& a : r->artifacts) {
      EXPECT_FALSE(contains(a.bytes, "IS_MODULO[0,AX1]=1"));
      EXPECT_FALSE(contains(a.bytes, "N3625"));
    }
  }
}

TEST(Rotary, StepThatDoesNotDivideTheTurnIsAnError) {
  std::mt19937 random(4);
  const auto m = table_axis(random, even(0.0, 30 * deg, 13));
  const auto r = Bench(m).write(siemens_plugin(), {{"step_deg", 7.0}});
  ASSERT_FALSE(r);
  EXPECT_TRUE(contains(r.error().message, "does not divide the turn: set step_deg = 7.2"))
      << r.error().message;
  EXPECT_TRUE(Bench(m).write(siemens_plugin(), {{"step_deg", 7.2}}));
}

// Turn after turn the increments must come back to where they were.
TEST(Rotary, FanucSumsOfATurnAreZero) {
  const std::uint32_t seed = 362;
  print_seed(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 40; ++round) {
    auto m = table_axis(random, even(0.0, 15 * deg, 25));
    m.plus = [e = m.plus](double x) { return e(x) + 0.5 * arcsec * x; };  // does not close
    m.minus = [e = m.plus](double x) { return e(x) + 5 * arcsec; };
    const auto r = Bench(m).write(fanuc_plugin(), {{"extended", true},
                                                   {"detection_unit_arcsec", 0.36},
                                                   {"reference_number", std::int64_t{60}}});
    ASSERT_TRUE(r) << r.error().message;
    const std::string text = file(*r, "fanuc-C.prm");
    int sum = 0, first = 0, last = 0;
    for (const std::string& line : lines(text)) {
      if (line.rfind("N100", 0) != 0) continue;
      last = std::stoi(line.substr(7));
      if (line.rfind("N10060P", 0) == 0) {
        first = last;
      } else {
        sum += last;
      }
    }
    ASSERT_EQ(sum, 0) << "seed " << seed;
    ASSERT_EQ(first, last) << "seed " << seed;
  }
}

}  // namespace rotary_test
