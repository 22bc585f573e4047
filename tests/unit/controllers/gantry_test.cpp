// SPDX-License-Identifier: Apache-2.0
// Tables of a gantry: what the written text does to a rigid beam that two sides drive.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <regex>

#include "workshop.h"

namespace gantry_test {

using namespace workshop;

namespace {

constexpr std::size_t n = 20;

/// A gantry of X with a beam along Y, and what is measured on it.
struct Gantry {
  double x0 = 0.0, y0 = 0.0, Lx = 12.0, Ly = 9.0;
  double one = 0.3, other = 8.7;  ///< lines of both sides on Y
  double squareness = 30e-6, odd = 0.0;
  Curve pitch, yaw;  ///< of X; both 0 at x0
  std::string slave = "X2";

  double s_of(double v, double from, double length) const { return (v - from) / length; }
  double f_even(double x) const { return 40 * um * std::sin(std::numbers::pi * s_of(x, x0, Lx)); }
  double f_odd(double x) const { return odd * std::sin(2 * std::numbers::pi * s_of(x, x0, Lx)); }
  double g(double y) const { return -25 * um * std::sin(std::numbers::pi * s_of(y, y0, Ly)); }
  double Y(double y) const { return 5 * um * std::sin(3.0 * s_of(y, y0, Ly)); }
  double ex(double x, double y) const {
    return pitch(x) - (y - y0) * yaw(x) + g(y) - squareness * (y - y0);
  }
  double ey(double x, double y) const { return f_even(x) + f_odd(x) + Y(y); }
  double x(std::size_t i) const { return x0 + Lx * static_cast<double>(i) / n; }
  double y(std::size_t i) const { return y0 + Ly * static_cast<double>(i) / n; }
};

Gantry random_gantry(std::mt19937& random) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Gantry m;
  m.Lx = 4.0 + 16.0 * u(random), m.Ly = 2.0 + 6.0 * u(random);
  for (double* travel : {&m.Lx, &m.Ly})
    *travel = std::round(*travel / 0.02) * 0.02;  // whole mm a step
  m.x0 = u(random) < 0.5 ? 0.0 : -m.Lx / 2.0;
  m.one = m.y0 + 0.05 * m.Ly, m.other = m.y0 + 0.9 * m.Ly;
  if (u(random) < 0.5) std::swap(m.one, m.other);
  m.squareness = (u(random) - 0.5) * 80e-6;
  const double size = 20 * um * u(random), turn = 15e-6 * u(random), waves = 1.0 + 3.0 * u(random);
  const double start = m.x0, length = m.Lx;
  m.pitch = [=](double x) { return size * std::sin(waves * (x - start) / length * 3.0); };
  m.yaw = [=](double x) { return turn * std::sin(waves * (x - start) / length * 2.0); };
  m.slave = u(random) < 0.5 ? "X2" : "U";
  return m;
}

/// The deviation along D1 (rising) or D2, from the first stop on.
template <class Error>
double along(const Gantry& m, bool rising, std::size_t i, const Error& error) {
  const double L = std::hypot(m.Lx, m.Ly), c = m.Lx / L, s = (rising ? m.Ly : -m.Ly) / L;
  const auto [ex, ey] = error(m.x(i), m.y(rising ? i : n - i));
  return c * ex + s * ey;
}

Bench bench_of(const Gantry& m, bool both_sides = true) {
  Bench bench;
  bench.campaign.machine.structure = "gantry";
  const auto error = [&](double x, double y) { return std::pair(m.ex(x, y), m.ey(x, y)); };
  std::vector<double> xs, ys;
  for (std::size_t i = 0; i <= n; ++i) xs.push_back(m.x(i)), ys.push_back(m.y(i));
  for (const auto& [id, y, side] :
       {std::tuple{"one", m.one, "master"}, {"other", m.other, "slave"}}) {
    if (!both_sides && side == std::string("slave")) continue;
    const Curve e = [&m, y = y](double x) { return m.pitch(x) - (y - m.y0) * m.yaw(x); };
    bench.add({.axis = "X", .id = id, .targets = xs, .plus = e, .minus = e});
    bench.campaign.measurements.back().side = side;
    bench.campaign.measurements.back().at = {{"Y", y}};
  }
  const Curve e = [&m](double y) { return m.Y(y); };
  bench.add({.axis = "Y", .id = "Y", .targets = ys, .plus = e, .minus = e});
  bench.campaign.machine.axes.front().slave = m.slave;
  bench.campaign.machine.axes.push_back(
      {.name = m.slave, .active_table = "", .active_backlash = 0.0});

  Results::Analysed a{"diagonal-straightness", "1.0.0", "D1", {}};
  Evaluation& r = a.evaluation;
  r.uses = {"one", "other", "Y"};
  r.values.push_back({"C0Y", m.squareness, Quantity::small_angle});
  const bool apart = m.odd == 0.0;
  Series EYX{apart ? "EYX" : "EYX_even", "X", Quantity::length, Quantity::deviation, xs, {}, {}},
      EXY{apart ? "EXY" : "EXY_even", "Y", Quantity::length, Quantity::deviation, ys, {}, {}},
      q_odd{"q_odd", "X", Quantity::length, Quantity::deviation, xs, {}, {}};
  PointTable::Column target{"target", Quantity::length, {}}, D1{"D1", Quantity::deviation, {}},
      D2{"D2", Quantity::deviation, {}};
  for (std::size_t i = 0; i <= n; ++i) {
    EYX.value.push_back(m.f_even(xs[i]));
    EXY.value.push_back(m.g(ys[i]));
    q_odd.value.push_back(m.Ly / std::hypot(m.Lx, m.Ly) * m.f_odd(xs[i]));
    target.values.push_back(static_cast<double>(i));
    D1.values.push_back(along(m, true, i, error) - along(m, true, 0, error));
    D2.values.push_back(along(m, false, i, error) - along(m, false, 0, error));
  }
  r.points.columns = {target, D1, D2};
  r.series = apart ? std::vector{EYX, EXY} : std::vector{EYX, EXY, q_odd};
  bench.results.analyses.push_back(std::move(a));
  return bench;
}

/// Points of one table; what it adds is the opposite of an entry.
struct Points {
  std::vector<double> at, entry;
  double operator()(double x) const { return -math::ErrorCurve::at(at, entry, x); }
};
/// By output and input, AXn: read here from the text of every file.
using Text = std::map<std::pair<std::string, std::string>, Points>;

std::string value_in(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key);
  return at == std::string::npos
             ? ""
             : text.substr(at + key.size(), text.find('\n', at) - at - key.size());
}

void read_table(const std::string& text, const std::string& entry, const std::string& keys,
                const std::string& index, Points& to) {
  const double first = std::stod(value_in(text, keys + "_MIN[" + index + "]=")),
               step = std::stod(value_in(text, keys + "_STEP[" + index + "]="));
  for (std::size_t i = 0;; ++i) {
    std::string key = entry;
    key.replace(key.find('#'), 1, std::to_string(i));
    const std::string value = value_in(text, key);
    if (value.empty()) return;
    to.at.push_back((first + step * static_cast<double>(i)) * mm);
    to.entry.push_back(std::stod(value) * mm);
  }
}

Text siemens_text(const OutputResult& result) {
  Text out;
  for (const Artifact& a : result.artifacts) {
    for (int t = 0; t < 20; ++t) {
      const std::string k = std::to_string(t),
                        to = value_in(a.bytes, "$AN_CEC_OUTPUT_AXIS[" + k + "]=");
      if (to.empty()) continue;
      const std::string from = value_in(a.bytes, "$AN_CEC_INPUT_AXIS[" + k + "]=");
      read_table(a.bytes, "$AN_CEC[" + k + ",#]=", "$AN_CEC", k,
                 out[{to.substr(1, to.size() - 2), from.substr(1, from.size() - 2)}]);
    }
    for (int axis = 1; axis < 10; ++axis) {
      const std::string ax = "AX" + std::to_string(axis);
      if (value_in(a.bytes, "$AA_ENC_COMP_MIN[0," + ax + "]=").empty()) continue;
      read_table(a.bytes, "$AA_ENC_COMP[0,#," + ax + "]=", "$AA_ENC_COMP", "0," + ax,
                 out[{ax, ax}]);
    }
  }
  return out;
}

struct Left {
  double D1 = 0.0, D2 = 0.0,
         apart = 0.0;  ///< ranges; largest difference of the sides' corrections without pitch
};

/// The beam is rigid: at y it moves by what both sides move, in proportion to the distances.
Left left_on(const Gantry& m, const Text& tables, const std::string& slave) {
  const auto added = [&](const std::string& out, double x, double y, bool own = true) {
    double sum = 0.0;
    for (const auto& [axes, t] : tables)
      if (axes.first == out && (own || axes.second == "AX2"))
        sum += t(axes.second == "AX2" ? y : x);
    return sum;
  };
  Left left;
  for (const bool rising : {true, false}) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = 0; i <= n; ++i) {
      const double v = along(m, rising, i, [&](double x, double y) {
        const double c1 = added("AX1", x, y), c2 = added(slave, x, y),
                     share = 1.0 - (y - m.one) / (m.other - m.one);
        left.apart =
            std::max(left.apart, std::fabs(added("AX1", x, y, false) - added(slave, x, y, false)));
        return std::pair(m.ex(x, y) + share * c1 + (1.0 - share) * c2,
                         m.ey(x, y) + added("AX2", x, y));
      });
      low = std::min(low, v), high = std::max(high, v);
    }
    (rising ? left.D1 : left.D2) = high - low;
  }
  return left;
}

TEST(Gantry, BothSidesGetTheCrossTable) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const Gantry m = random_gantry(random);
    const double reference = seed % 3 == 0 ? m.x0 + 0.7 * m.Lx : 0.0;
    const std::string said =
        reference == 0.0 ? "" : " reference_mm=" + std::to_string(reference / mm);
    const std::string slave = "AX" + std::to_string(3 + seed % 5);
    const auto result = bench_of(m).write(
        siemens_plugin(),
        {{"axes", std::vector<std::string>{"X number=1" + said, "Y number=2",
                                           m.slave + " number=" + slave.substr(2) + said}}});
    ASSERT_TRUE(result) << result.error().message;
    const Text tables = siemens_text(*result);
    ASSERT_TRUE(tables.contains({slave, "AX2"}));
    const Left left = left_on(m, tables, slave);
    EXPECT_LT(left.D1, 0.2 * um);
    EXPECT_LT(left.D2, 0.2 * um);
    EXPECT_EQ(left.apart, 0.0);
    EXPECT_NEAR(prediction(*result, "D1").after, left.D1, 0.01 * um);
    EXPECT_NEAR(prediction(*result, "D2").after, left.D2, 0.01 * um);
    Text dropped = tables;
    dropped.erase({slave, "AX2"});
    EXPECT_GT(left_on(m, dropped, slave).D1, 5 * um);
    const std::string words = file(*result, "siemens-840d-XY-CEC.ini");
    for (const std::string& axis :
         {std::string("X (AX1)"), std::string("Y (AX2)"), m.slave + " (" + slave + ")"})
      EXPECT_TRUE(contains(words.substr(words.find("MD32710"), 60), axis)) << words;
  }
}

TEST(Gantry, ThePredictionHasThePitchTablesOfBothSides) {
  std::mt19937 random(7);
  Gantry m = random_gantry(random);
  m.pitch = [&](double x) { return 60 * um * std::sin(4.0 * (x - m.x0) / m.Lx); };
  const auto result = bench_of(m).write(siemens_plugin());
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_GT(prediction(*result, "D1").before, 20 * um);
  EXPECT_LT(prediction(*result, "D1").after, 0.2 * um);
}

TEST(Gantry, TwoDiagonalsAloneTakeTheEvenParts) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Gantry m = random_gantry(random);
    m.odd = 15 * um;
    const auto result = bench_of(m).write(
        siemens_plugin(),
        {{"axes", std::vector<std::string>{"X number=1", "Y number=2", m.slave + " number=4"}}});
    ASSERT_TRUE(result) << result.error().message;
    const Left left = left_on(m, siemens_text(*result), "AX4");
    const double q = m.Ly / std::hypot(m.Lx, m.Ly) * 15 * um;
    EXPECT_NEAR(left.D1, 2.0 * q, 0.3 * um);
    EXPECT_NEAR(prediction(*result, "D1").after, left.D1, 0.01 * um);
    const Finding* f = finding(*result, "table.cross-even-only");
    ASSERT_NE(f, nullptr);
    EXPECT_NEAR(f->evidence.front().value, q, 0.01 * um);
    EXPECT_TRUE(
        contains(file(*result, "siemens-840d-XY-CEC.ini"), "NOT in these tables: the odd part"));
  }
}

TEST(Gantry, TwoDiagonalsReadAgainAfterTheCompensationGiveNoSecondTable) {
  std::mt19937 random(11);
  Gantry m = random_gantry(random);
  m.odd = 15 * um;
  Bench bench = bench_of(m);
  Results::Analysed again = bench.results.analyses.front();
  again.measurement = "D1 final";
  again.evaluation.findings.push_back({.id = "diagonals.remeasured"});
  bench.results.analyses.push_back(std::move(again));
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_TRUE(has_file(*result, "siemens-840d-XY-CEC.ini"));
  EXPECT_EQ(std::count_if(result->artifacts.begin(), result->artifacts.end(),
                          [](const Artifact& a) { return contains(a.name, "CEC"); }),
            1);
}

TEST(Gantry, HeidenhainHasAColumnForEachSide) {
  for (const char* layout : {"tnc640", "itnc530"})
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(layout + (" seed " + std::to_string(seed)));
      std::mt19937 random(seed);
      const Gantry m = random_gantry(random);
      const auto result = bench_of(m).write(heidenhain_plugin(), {{"layout", std::string(layout)}});
      ASSERT_TRUE(result) << result.error().message;
      const std::vector<Artifact> com{{"", file(*result, "heidenhain-tnc-Y.COM")}};
      const auto tables = read_back(heidenhain_plugin(), com, {},
                                    {{.name = "X"}, {.name = "Y"}, {.name = m.slave}});
      ASSERT_TRUE(tables) << tables.error().message;
      std::map<std::string, std::vector<double>> columns;
      for (const LoadedTable& t : *tables) columns[t.output] = t.plus;
      ASSERT_EQ(columns.size(), 3U);
      EXPECT_EQ(columns["X"], columns[m.slave]);
      EXPECT_LT(prediction(*result, "D1").after, 0.6 * um);
    }
}

TEST(Gantry, WhereTheSecondSideIsNotDocumentedThereIsNoTable) {
  std::mt19937 random(3);
  Gantry m = random_gantry(random);
  while (m.x0 != 0.0) m = random_gantry(random);  // these count from home
  for (const auto& [built, options, cross] :
       {std::tuple{"aerotech", Options{}, "aerotech-plane-D1.cal"},
        {"twincat-volumetric", {{"sign", std::string("error")}}, "twincat-volumetric-XY.csv"}}) {
    const auto result = bench_of(m).write(plugin(built), options);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_FALSE(has_file(*result, cross));
    EXPECT_NE(finding(*result, "table.gantry-second-side"), nullptr) << built;
  }
  const auto result =
      bench_of(m).write(plugin("twincat-cnc"), {{"cross_sign", std::string("error")}});
  ASSERT_TRUE(result) << result.error().message;
  for (const std::string& axis : {std::string("X"), m.slave})
    EXPECT_TRUE(has_file(*result, "twincat-cnc-cross-" + axis + ".lis")) << axis;
  EXPECT_LT(prediction(*result, "D1").after, 0.6 * um);
}

TEST(Gantry, OneSideAloneGetsNoPitchTable) {
  std::mt19937 random(5);
  Bench bench = bench_of(random_gantry(random), false);
  bench.results.analyses.clear();
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_FALSE(has_file(*result, "siemens-840d-X-EEC.ini"));
  EXPECT_TRUE(has_file(*result, "siemens-840d-Y-EEC.ini"));
  EXPECT_NE(finding(*result, "table.gantry-one-side"), nullptr);
}

TEST(Gantry, DirectionTablesOfASlaveWithAHighNumberDoNotMeetTheCrossTables) {
  std::mt19937 random(5);
  const Gantry m = random_gantry(random);
  const auto result = bench_of(m).write(
      siemens_plugin(),
      {{"directions", true},
       {"axes", std::vector<std::string>{"X number=1", "Y number=2", m.slave + " number=7"}}});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_TRUE(contains(file(*result, "siemens-840d-XY-CEC.ini"), "$AN_CEC_OUTPUT_AXIS[14]="));
}

}  // namespace

}  // namespace gantry_test
