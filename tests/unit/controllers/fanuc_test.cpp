// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <numbers>

#include "workshop.h"

namespace fanuc_test {

using namespace workshop;

namespace {

// Parameter (of axis 1) or pitch datum by number, read here without the plugin's code.
std::map<int, int> numbers(const std::string& text) {
  std::map<int, int> out;
  for (const std::string& line : lines(text)) {
    if (line == "%") continue;
    int n = 0, p = 0;
    std::from_chars(line.data() + 1, line.data() + line.size(), n);
    const std::size_t at = line.find('P');
    std::from_chars(line.data() + at + 1, line.data() + line.size(), p);
    out[n] = p;
  }
  return out;
}

Measured axis(std::vector<double> targets, Curve plus, double B) {
  Measured m;
  m.targets = std::move(targets);
  m.plus = std::move(plus);
  m.minus = [p = m.plus, B](double x) { return p(x) - B; };
  return m;
}

}  // namespace

// The rule behind the maker's printed list 33..49: reference number 40 at 0, interval 50 mm;
// number 40 covers -50..0, 41 covers 0..50, 33 covers -400..-350.
TEST(Fanuc, NumbersOfThePrintedExample) {
  const auto m = axis(
      even(-400 * mm, 50 * mm, 18), [](double x) { return x * 20e-6; }, 0.0);
  const auto r = Bench(m).write(fanuc_plugin(), {{"reference_number", std::int64_t{40}}});
  ASSERT_TRUE(r) << r.error().message;
  const auto n = numbers(file(*r, "fanuc-X.prm"));
  EXPECT_EQ(n.at(3620), 40);
  EXPECT_EQ(n.at(3621), 33);
  EXPECT_EQ(n.at(3622), 49);
  EXPECT_EQ(n.at(3623), 1);
  EXPECT_EQ(n.at(3624), 50000);
  EXPECT_EQ(n.count(3605), 0U) << "a bit parameter is not ours to overwrite";
  // 20 um/m too far: 1 um shorter in each 50 mm
  for (int k = 33; k <= 49; ++k) EXPECT_EQ(n.at(10000 + k), -1) << k;
  EXPECT_EQ(n.count(10032), 0U);
  EXPECT_EQ(n.count(10050), 0U);
  EXPECT_LT(prediction(*r, "E").after, 1e-9);
}

TEST(Fanuc, BlockByHand) {
  // mean -4, 0, 3 um at -100, 0, 100 mm; B = -6 um
  const auto m = axis(
      {-100 * mm, 0.0, 100 * mm},
      [](double x) {
        return (x < -0.05 ? -7 : x < 0.05 ? -3 : 0) * um;
      },
      -6 * um);
  const auto r = Bench(m).write(fanuc_plugin(), {{"reference_number", std::int64_t{40}}});
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(file(*r, "fanuc-X.prm"),
            "%\nN1851A1P6\nN3620A1P40\nN3621A1P40\nN3622A1P41\nN3623A1P1\nN3624A1P100000\n"
            "N10040P-4\nN10041P-3\n%\n");
  EXPECT_LT(prediction(*r, "E").after, 1e-9);
}

// 3621 <= 3620 < 3622 also for an axis whose reference is at an end.
TEST(Fanuc, ReferenceAtTheEnds) {
  for (const double reference : {0.0, 200.0}) {
    const auto m = axis(
        even(0.0, 50 * mm, 5), [](double x) { return x * 40e-6; }, -3 * um);
    const auto r = Bench(m).write(
        fanuc_plugin(),
        {{"axes",
          std::vector<std::string>{reference == 0.0 ? "X reference_number=100 reference_mm=0"
                                                    : "X reference_number=100 reference_mm=200"}}});
    ASSERT_TRUE(r) << r.error().message;
    const auto n = numbers(file(*r, "fanuc-X.prm"));
    EXPECT_LE(n.at(3621), n.at(3620));
    EXPECT_LT(n.at(3620), n.at(3622));
    EXPECT_EQ(n.at(3620), 100);
    EXPECT_LT(prediction(*r, "E").after, 1e-9);
  }
}

// Unlike a zero offset, a wrong reference position shifts the table along the axis: it is machine
// zero unless it is said, also where the measured range does not begin there.
TEST(Fanuc, ReferenceIsMachineZeroOutsideOfTheRangeToo) {
  const auto m = axis(
      even(100 * mm, 50 * mm, 5), [](double x) { return x * 40e-6; }, -3 * um);
  const auto r = Bench(m).write(fanuc_plugin(), {{"reference_number", std::int64_t{10}}});
  ASSERT_TRUE(r) << r.error().message;
  const auto n = numbers(file(*r, "fanuc-X.prm"));
  EXPECT_EQ(n.at(3620), 10);
  EXPECT_EQ(n.at(3622), 16);  // 0 to 300 mm in parts of 50
  EXPECT_EQ(n.at(10011), 0);  // 0..50: the end holds
  EXPECT_EQ(n.at(10012), 0);
  EXPECT_EQ(n.at(10013), -2);  // 100..150 mm
  EXPECT_LT(prediction(*r, "E").after, 0.6 * um);
}

// Reference 60, 45 deg: the last number is 68, 60 repeats it, and the turn adds up to zero.
TEST(Fanuc, TurnOfThePrintedExample) {
  Measured m = axis(
      even(0.0, 45 * deg, 9), [](double x) { return 20 * arcsec * std::sin(x + 1); },
      -7.2 * arcsec);
  m.axis = m.id = "C";
  m.rotary = true;
  const auto r = Bench(m).write(fanuc_plugin(), {{"reference_number", std::int64_t{60}}});
  ASSERT_TRUE(r) << r.error().message;
  const auto n = numbers(file(*r, "fanuc-C.prm"));
  EXPECT_EQ(n.at(3621), 60);
  EXPECT_EQ(n.at(3622), 68);
  EXPECT_EQ(n.at(3624), 45000);
  EXPECT_EQ(n.at(3625), 360000);
  EXPECT_EQ(n.at(1851), 2);
  int sum = 0;
  for (int k = 61; k <= 68; ++k) sum += n.at(10000 + k);
  EXPECT_EQ(sum, 0);
  EXPECT_EQ(n.at(10060), n.at(10068));
  EXPECT_LT(prediction(*r, "E").after, 2 * 3.6 * arcsec);
}

TEST(Fanuc, IncrementsOutOfRangeAreAnErrorWithASuggestionThatWorks) {
  const auto m = axis(
      even(0.0, 100 * mm, 6), [](double x) { return x * 300e-6; }, -6 * um);
  const auto r = Bench(m).write(fanuc_plugin());
  ASSERT_FALSE(r);
  EXPECT_TRUE(contains(r.error().message, "increment of -30")) << r.error().message;
  const std::size_t at = r.error().message.find("magnification = ") + 16;
  const std::int64_t magnification = std::stoll(r.error().message.substr(at));
  EXPECT_TRUE(Bench(m).write(fanuc_plugin(), {{"magnification", magnification}}));
  EXPECT_TRUE(Bench(m).write(fanuc_plugin(), {{"extended", true}}));
}

// 600 um in an interval fit 7 x 86 and more, 900 um do not fit 7 x 100: nothing over 100 is
// advised.
TEST(Fanuc, AdvisesNoMagnificationThatTheOptionRefuses) {
  for (const double slope : {6e-3, 9e-3}) {
    const auto m = axis(
        even(0.0, 100 * mm, 6), [slope](double x) { return x * slope; }, -6 * um);
    const auto r = Bench(m).write(fanuc_plugin());
    ASSERT_FALSE(r);
    const std::string& said = r.error().message;
    if (slope > 7e-3) {
      EXPECT_TRUE(contains(said, "repair the axis or measure it again")) << said;
      EXPECT_FALSE(contains(said, "set magnification")) << said;
      EXPECT_FALSE(Bench(m).write(fanuc_plugin(), {{"magnification", std::int64_t{100}}}));
      continue;
    }
    const std::size_t at = said.find("set magnification = ");
    ASSERT_NE(at, std::string::npos) << said;
    const std::int64_t advised = std::stoll(said.substr(at + 20));
    EXPECT_LE(advised, 100);
    EXPECT_TRUE(Bench(m).write(fanuc_plugin(), {{"magnification", advised}}));
  }
}

TEST(Fanuc, ATableThatMakesTheMeanWorseSaysSo) {
  const std::array<double, 13> plus = {-0.67, 0.22, 0.47,  0.21,  -0.40, -1.37, -1.53,
                                       -1.75, -2.1, -1.73, -2.29, -1.44, -0.71},
                               minus = {1.27, 2.15, 2.81, 2.13,  1.68, 0.77, 0.36,
                                        0.19, 0.0,  0.11, -0.11, 0.64, 1.14};
  const auto at = [](const std::array<double, 13>& values, double x) {
    return values[static_cast<std::size_t>(std::lround((x + 180 * deg) / (30 * deg)))] * arcsec;
  };
  Measured m;
  m.axis = m.id = "C";
  m.rotary = true;
  m.targets = even(-180 * deg, 30 * deg, 13);
  m.plus = [&](double x) { return at(plus, x); };
  m.minus = [&](double x) { return at(minus, x); };
  for (const double unit : {0.36, 3.6}) {
    const auto r = Bench(m).write(fanuc_plugin(), {{"detection_unit_arcsec", unit}});
    ASSERT_TRUE(r) << r.error().message;
    EXPECT_EQ(prediction(*r, "M").after > prediction(*r, "M").before, unit == 3.6);
    EXPECT_LT(prediction(*r, "E").after, prediction(*r, "E").before);
    EXPECT_EQ(finding(*r, "table.worse-mean") != nullptr, unit == 3.6);
  }
}

TEST(Fanuc, MagnificationScalesThePulses) {
  const auto m = axis(
      even(0.0, 100 * mm, 6), [](double x) { return x * 300e-6; }, -6 * um);
  const auto r = Bench(m).write(fanuc_plugin(), {{"magnification", std::int64_t{5}}});
  ASSERT_TRUE(r) << r.error().message;
  const auto n = numbers(file(*r, "fanuc-X.prm"));
  EXPECT_EQ(n.at(3623), 5);
  EXPECT_EQ(n.at(10000 + n.at(3622)), -6);     // 30 um in units of 5
  EXPECT_EQ(n.at(1851), 6);                    // backlash knows no magnification
  EXPECT_LT(prediction(*r, "E").after, 6e-8);  // 300 um/m of 156 um
}

TEST(Fanuc, DirectionsByHand) {
  for (const bool plus : {true, false}) {
    Measured m = axis(
        {0.0, 100 * mm, 200 * mm},
        [](double x) {
          return (x < 0.05 ? 0 : x < 0.15 ? 2 : 5) * um;
        },
        0.0);
    m.minus = [](double x) { return (x < 0.05 ? 4 : x < 0.15 ? 3 : 9) * um; };
    const auto r =
        Bench(m).write(fanuc_plugin(), {{"directions", true},
                                        {"reference_number", std::int64_t{10}},
                                        {"reference_return", std::string(plus ? "+" : "-")}});
    ASSERT_TRUE(r) << r.error().message;
    const auto n = numbers(file(*r, "fanuc-X.prm"));
    EXPECT_EQ(n.at(1851), 0);
    EXPECT_EQ(n.at(3621), 10);
    EXPECT_EQ(n.at(3622), 12);
    EXPECT_EQ(n.at(3626), 3010);
    EXPECT_EQ(n.at(3627), plus ? -4 : 4);
    EXPECT_EQ(n.at(10010), 0);
    EXPECT_EQ(n.at(10011), -2);
    EXPECT_EQ(n.at(10012), -3);
    EXPECT_EQ(n.at(13010), 0);
    EXPECT_EQ(n.at(13011), 1);
    EXPECT_EQ(n.at(13012), -6);
    EXPECT_LT(prediction(*r, "E").after, 1e-9);
  }
}

TEST(Fanuc, TwoAxesDoNotShareNumbers) {
  Bench b(axis(
      even(0.0, 100 * mm, 6), [](double x) { return x * 30e-6; }, -6 * um));
  Measured y = axis(
      even(0.0, 100 * mm, 4), [](double x) { return x * -30e-6; }, -6 * um);
  y.axis = y.id = "Y";
  b.add(y);
  const auto r = b.write(fanuc_plugin());
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_TRUE(contains(file(*r, "fanuc-Y.prm"), "N3621A2P6\n")) << file(*r, "fanuc-Y.prm");
  const auto refused = b.write(fanuc_plugin(), {{"reference_number", std::int64_t{40}}});
  ASSERT_FALSE(refused);
  EXPECT_TRUE(contains(refused.error().message, "would share numbers")) << refused.error().message;
  const auto told = b.write(
      fanuc_plugin(),
      {{"axes", std::vector<std::string>{"X reference_number=40", "Y reference_number=99"}}});
  ASSERT_TRUE(told) << told.error().message;
  EXPECT_TRUE(contains(file(*told, "fanuc-Y.prm"), "N3620A2P99\n"));
}

// The whole chain: sums of the numbers in the file stay within half a unit of -e everywhere.
TEST(Fanuc, SumsFollowTheCurveWithinHalfAUnit) {
  const std::uint32_t seed = 4711;
  print_seed(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 60; ++round) {
    Measured m = axis(even(-250 * mm, 25 * mm, 41), random_curve(random, 1.0, 15 * um), -5 * um);
    Bench b(m);
    const auto r =
        b.write(fanuc_plugin(), {{"extended", true}, {"reference_number", std::int64_t{100}}});
    ASSERT_TRUE(r) << r.error().message;
    const auto n = numbers(file(*r, "fanuc-X.prm"));
    const auto curve = curve_of(b);
    const double zero = curve.mean[10];  // at 0 mm
    int sum = 0;
    for (int k = 101; k <= n.at(3622); ++k) {
      sum += n.at(10000 + k);
      const double wanted = -(curve.mean.at(static_cast<std::size_t>(k) - 90) - zero);
      ASSERT_LE(std::fabs(sum * um - wanted), 0.5 * um * (1 + 1e-9)) << "seed " << seed;
    }
    sum = 0;
    for (int k = 100; k >= n.at(3621); --k) {
      sum -= n.at(10000 + k);
      const double wanted = -(curve.mean.at(static_cast<std::size_t>(k) - 91) - zero);
      ASSERT_LE(std::fabs(sum * um - wanted), 0.5 * um * (1 + 1e-9)) << "seed " << seed;
    }
    ASSERT_LT(prediction(*r, "M").after, 1.1 * um);
    // Read back, the increments are their sums again, zero at the reference.
    const auto back = control(fanuc_plugin(), r->artifacts,
                              {{"extended", true}, {"reference_number", std::int64_t{100}}});
    ASSERT_TRUE(back) << back.error().message;
    for (std::size_t i = 0; i < curve.mean.size(); ++i) {
      const double at = (static_cast<double>(i) * 25 - 250) * mm;
      ASSERT_NEAR(((*back)(at, 1) + (*back)(at, -1)) / 2.0, -(curve.mean[i] - zero), 0.51 * um)
          << "seed " << seed;
    }
  }
}

}  // namespace fanuc_test
