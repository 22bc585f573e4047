// SPDX-License-Identifier: Apache-2.0
// Tables of one axis over the other, from the diagonals.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "machine.h"
#include "nonio/controllers/text.h"
#include "workshop.h"

namespace cross_test {

using namespace workshop;

namespace {

constexpr std::size_t n = 30;
constexpr double Lx = 12.0, Ly = 9.0, square = 8e-6;

double f(double x) { return 40 * um * std::sin(std::numbers::pi * x / Lx); }
double g(double y) { return -25 * um * std::sin(2.0 * std::numbers::pi * y / Ly); }

/// What the analysis of two diagonals says of a machine with f, g and squareness only.
Results::Analysed analysed(bool separable) {
  Results::Analysed a{"diagonal-straightness", "1.0.0", "D1", {}};
  Evaluation& e = a.evaluation;
  e.values.push_back({"C0Y", square, Quantity::small_angle});
  Series EYX{"EYX", "X", Quantity::length, Quantity::deviation, {}, {}, {}};
  Series EXY{"EXY", "Y", Quantity::length, Quantity::deviation, {}, {}, {}};
  PointTable::Column target{"target", Quantity::length, {}}, D1{"D1", Quantity::deviation, {}},
      D2{"D2", Quantity::deviation, {}};
  for (std::size_t i = 0; i <= n; ++i) {
    const double t = static_cast<double>(i) / n, x = Lx * t, y = Ly * t, down = Ly - y;
    EYX.position.push_back(x), EYX.value.push_back(f(x));
    EXY.position.push_back(y), EXY.value.push_back(g(y));
    target.values.push_back(15.0 * t);
    D1.values.push_back(0.8 * (g(y) - square * y) + 0.6 * f(x));
    D2.values.push_back(0.8 * (g(down) - square * (down - Ly)) - 0.6 * f(x));
  }
  e.points.columns = {target, D1, D2};
  if (separable) e.series = {EYX, EXY};
  return a;
}

Bench gantry() {
  Bench bench;
  for (const auto& [axis, length] : {std::pair{"X", Lx}, {"Y", Ly}})
    bench.add({.axis = axis,
               .id = axis,
               .targets = even(0.0, length / n, n + 1),
               .plus = [](double) { return 0.0; },
               .minus = [](double) { return 0.0; }});
  return bench;
}

TEST(Cross, SiemensTablesTakeStraightnessAndSquarenessAway) {
  Bench bench = gantry();
  bench.results.analyses.push_back(analysed(true));
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result) << result.error().message;
  const std::string text = file(*result, "siemens-840d-XY-CEC.ini");
  EXPECT_TRUE(contains(text, "$AN_CEC[0,15]=0.04\n")) << text;  // +e of Y at the middle of X
  EXPECT_TRUE(contains(text, "$AN_CEC[1,30]=-0.072\n"));        // -C0Y Ly of X at the end of Y
  EXPECT_TRUE(contains(text, "$AN_CEC_INPUT_AXIS[0]=(AX1)\n$AN_CEC_OUTPUT_AXIS[0]=(AX2)\n"));
  EXPECT_TRUE(contains(text, "$AN_CEC_INPUT_AXIS[1]=(AX2)\n$AN_CEC_OUTPUT_AXIS[1]=(AX1)\n"));
  const auto y = control_cross(siemens_plugin(), {{"", text}}, "X", "Y");
  const auto x = control_cross(siemens_plugin(), {{"", text}}, "Y", "X");
  ASSERT_TRUE(x && y);
  for (std::size_t i = 0; i <= n; ++i) {
    const double at = static_cast<double>(i) / n;
    EXPECT_NEAR((*y)(Lx * at, 1), -f(Lx * at), 2e-9);
    EXPECT_NEAR((*x)(Ly * at, -1), -(g(Ly * at) - square * Ly * at), 2e-9);
  }
  for (const char* diagonal : {"D1", "D2"}) {
    EXPECT_GT(prediction(*result, diagonal).before, 40 * um);
    EXPECT_LT(prediction(*result, diagonal).after, 0.01 * um);
  }
}

const Remark* note(const OutputResult& r, const std::string& id, const std::string& axis) {
  for (const Remark& said : r.notes)
    if (said.id == id && said.texts.front().second == axis) return &said;
  return nullptr;
}

// Zero where all other tables are: at the reference point of the axis by which it is looked up, and
// not at the first point, where the axis may never be when the table is switched on.
TEST(Cross, ZeroAtTheReferencePointAndSaid) {
  struct Kind {
    Controller output;
    Options options;
    std::vector<std::string> files;
  };
  for (const Kind& k : {Kind{siemens_plugin(), {}, {"siemens-840d-XY-CEC.ini"}},
                        {heidenhain_plugin(), {}, {"heidenhain-tnc-X.COM"}},
                        {plugin("twincat-cnc"),
                         {{"cross_sign", std::string("error")}},
                         {"twincat-cnc-cross-Y.lis"}},
                        {plugin("twincat-volumetric"),
                         {{"sign", std::string("error")}},
                         {"twincat-volumetric-XY.csv"}}})
    for (const double reference : {0.0, 5.0, Lx}) {  // m
      Bench bench = gantry();
      bench.results.analyses.push_back(analysed(true));
      Options options = k.options;
      const bool said = reference > 0.0;
      if (said)
        options["axes"] =
            std::vector<std::string>{"X reference_mm=" + std::to_string(reference * 1e3)};
      const auto result = bench.write(k.output, options);
      const std::string who = k.output.info.name + " " + std::to_string(reference);
      ASSERT_TRUE(result) << who << result.error().message;
      std::vector<Artifact> files;
      for (const std::string& name : k.files) files.push_back({name, file(*result, name)});
      const auto y = control_cross(k.output, files, "X", "Y", options);
      ASSERT_TRUE(y) << who << y.error().message;
      for (const double x : {0.0, 3.6, 6.0, 12.0})
        EXPECT_NEAR((*y)(x, 1), -(f(x) - f(reference)), 0.1 * um + 0.0005 * um) << who << " " << x;
      EXPECT_NEAR((*y)(reference, 1), 0.0, 0.11 * um) << who;
      const Remark* zero =
          note(*result, said ? "table.cross-zero-at" : "table.cross-zero-taken", "Y");
      ASSERT_NE(zero, nullptr) << who;
      EXPECT_EQ(zero->evidence.front().value, reference) << who;
      EXPECT_LT(prediction(*result, "D1").after, 0.4 * um) << who;
      std::string text;
      for (const Artifact& a : result->artifacts) text += a.bytes;
      const std::string at = controllers::decimal(reference * 1e3, 4) + " mm";
      EXPECT_TRUE(contains(text, k.output.info.name == "twincat-volumetric"
                                     ? "errors over X: zero at " + at
                                     : "Y over X: zero at " + at + " of X" +
                                           (said ? ";" : ", taken as reference point;")))
          << who << text.substr(0, 1500);
    }
}

TEST(Cross, APlaneOfAerotechCountsFromHome) {
  Bench bench = gantry();
  bench.results.analyses.push_back(analysed(true));
  const Controller aerotech = plugin("aerotech");
  const auto result = bench.write(aerotech);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_TRUE(contains(file(*result, "aerotech-plane-D1.cal"), "; Y over X: zero at 0.0 mm of X"));
  bench.campaign.measurements.clear(), bench.observations.clear();  // diagonals alone
  const auto moved =
      bench.write(aerotech, {{"axes", std::vector<std::string>{"Y reference_mm=9000"}}});
  ASSERT_FALSE(moved);
  EXPECT_TRUE(contains(moved.error().message, "reference_mm must be 0")) << moved.error().message;
}

TEST(Cross, WhatTheMakerDoesNotAllowIsNotWritten) {
  for (const auto& [limit, stays] : {std::pair{"Y largest_um=39", false},
                                     {"Y largest_um=41", true},
                                     {"Y slope_um_per_m=10", false},
                                     {"Y slope_um_per_m=11", true}}) {
    Bench bench = gantry();
    bench.results.analyses.push_back(analysed(true));
    const auto result = bench.write(siemens_plugin(), {{"axes", std::vector<std::string>{limit}}});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(has_file(*result, "siemens-840d-XY-CEC.ini"), stays) << limit;
    EXPECT_EQ(finding(*result, "table.refused-cross") == nullptr, stays) << limit;
  }
}

TEST(Cross, AFlippedSignIsSeenByTheConsumer) {
  Bench bench = gantry();
  auto wrong = analysed(true);
  for (Series& s : wrong.evaluation.series)
    for (double& v : s.value) v = -v;
  wrong.evaluation.values[0].value = -square;
  bench.results.analyses.push_back(wrong);
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result);
  EXPECT_GT(prediction(*result, "D1").after, 1.9 * prediction(*result, "D1").before);
  EXPECT_NE(finding(*result, "table.no-gain-diagonal"), nullptr);
}

TEST(Cross, HeidenhainColumnsOfTheOtherAxis) {
  for (const char* layout : {"tnc640", "itnc530"}) {
    Bench bench = gantry();
    bench.results.analyses.push_back(analysed(true));
    const auto result = bench.write(heidenhain_plugin(), {{"layout", std::string(layout)}});
    ASSERT_TRUE(result) << result.error().message;
    const auto y =
        control_cross(heidenhain_plugin(), {{"", file(*result, "heidenhain-tnc-X.COM")}}, "X", "Y");
    const auto x =
        control_cross(heidenhain_plugin(), {{"", file(*result, "heidenhain-tnc-Y.COM")}}, "Y", "X");
    ASSERT_TRUE(x && y) << layout;
    for (std::size_t i = 0; i <= n; ++i) {
      const double at = static_cast<double>(i) / n;
      EXPECT_NEAR((*y)(Lx * at, 1), -f(Lx * at), 0.051 * um);
      EXPECT_NEAR((*x)(Ly * at, 1), -(g(Ly * at) - square * Ly * at), 0.051 * um);
    }
    EXPECT_LT(prediction(*result, "D1").after, 0.3 * um);  // four decimals of a millimetre
    EXPECT_LT(prediction(*result, "D2").after, 0.3 * um);
  }
}

TEST(Cross, WhatIsNotSeparatedHasNoTable) {
  Bench bench = gantry();
  bench.results.analyses.push_back(analysed(false));
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result);
  EXPECT_FALSE(has_file(*result, "siemens-840d-XY-CEC.ini"));
}

TEST(Cross, MorePointsThanTheControlTakesAreRefused) {
  Bench bench = gantry();
  bench.results.analyses.push_back(analysed(true));
  EXPECT_FALSE(bench.write(siemens_plugin(), {{"max_points", std::int64_t{20}}}));
}

/// A machine without angular errors: with these nine functions and three squarenesses step
/// diagonals know all of it.
machine::Errors volume_errors() {
  machine::Errors e;
  double size = 10 * um, waves = 1.0;
  for (const char axis : {'X', 'Y', 'Z'})
    for (const char along : {'X', 'Y', 'Z'}) {
      e[std::string("E") + along + axis] = [size, waves](double p) {
        return size * std::sin(waves * std::numbers::pi * p / 0.6) + 0.3 * size * p;
      };
      size = -1.15 * size, waves += 0.4;
    }
  e.C0Y = 31e-6, e.B0Z = -47e-6, e.A0Z = 23e-6;
  return e;
}

constexpr std::array<double, 3> travel{0.8, 0.6, 0.5};
constexpr std::size_t steps = 20;

/// What the analysis of step diagonals gives of it, and the readings of all four.
Bench volume(bool with_lengths) {
  Bench bench;
  machine::Errors errors = volume_errors();
  Results::Analysed a{"step-diagonal", "1.0.0", "SD", {}};
  a.evaluation.values = {{"C0Y", errors.C0Y, Quantity::small_angle},
                         {"B0Z", errors.B0Z, Quantity::small_angle},
                         {"A0Z", errors.A0Z, Quantity::small_angle}};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string axis(1, "XYZ"[k]);
    for (const char along : {'X', 'Y', 'Z'}) {
      Series s{"E" + std::string(1, along) + axis,
               axis,
               Quantity::length,
               Quantity::deviation,
               {},
               {},
               {}};
      for (std::size_t i = 0; i <= steps; ++i) {
        s.position.push_back(travel[k] * static_cast<double>(i) / steps);
        s.value.push_back(errors[s.name](s.position.back()) + 5 * um);  // its zero is free
      }
      a.evaluation.series.push_back(std::move(s));
    }
    const auto pitch = [curve = errors["E" + axis + axis]](double p) { return curve(p); };
    if (with_lengths) {
      bench.add({.axis = axis,
                 .id = axis,
                 .targets = even(0.0, travel[k] / steps, steps + 1),
                 .plus = pitch,
                 .minus = [pitch](double p) { return pitch(p) - 3 * um; }});
      a.evaluation.uses.push_back(axis);
    }
  }
  bench.results.analyses.push_back(std::move(a));
  Measurement m;
  m.id = "SD", m.kind = "step-diagonal";
  Observations o;
  o.measurement = "SD";
  const double L = std::hypot(travel[0], travel[1], travel[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string axis(1, "XYZ"[k]);
    m.from[axis] = 0.0, m.to[axis] = travel[k];
    o.axes.push_back({axis, false, {}, {}});
  }
  for (const auto& [name, sign] : {std::pair{"PPP", machine::Vector(1, 1, 1)},
                                   {"NPP", {-1, 1, 1}},
                                   {"PNP", {1, -1, 1}},
                                   {"PPN", {1, 1, -1}}}) {
    std::array<double, 3> u{};
    const auto at = [&sign = sign](std::size_t k, std::size_t moved) {
      const double part = static_cast<double>(moved) / steps;
      return travel[k] * (sign[static_cast<int>(k)] > 0 ? part : 1.0 - part);
    };
    for (std::size_t k = 0; k < 3; ++k) u[k] = sign[static_cast<int>(k)] * travel[k] / L;
    o.lines.push_back({std::string("SD ") + name, u});
    const auto error = [&](const machine::Vector& p) {
      return (machine::point(errors, p) - p).dot(machine::Vector(u[0], u[1], u[2]));
    };
    const double start = error({at(0, 0), at(1, 0), at(2, 0)});
    for (std::size_t move = 1; move <= 3 * steps; ++move) {
      const machine::Vector p(at(0, (move + 2) / 3), at(1, (move + 1) / 3), at(2, move / 3));
      for (std::size_t k = 0; k < 3; ++k) {
        o.axes[k].position.push_back(p[static_cast<int>(k)]);
        o.axes[k].approach.push_back(sign[static_cast<int>(k)] > 0 ? 1 : -1);
      }
      o.deviation.push_back(error(p) - start);
      o.line.push_back(static_cast<std::uint32_t>(o.lines.size() - 1));
    }
  }
  for (const char* axis : {"X", "Y", "Z"})
    if (bench.campaign.machine.axis(axis) == nullptr)
      bench.campaign.machine.axes.push_back(
          Axis{.name = axis, .active_table = "", .active_backlash = 0.0});
  bench.campaign.measurements.push_back(std::move(m));
  bench.observations.push_back(std::move(o));
  return bench;
}

using Tables = std::map<std::pair<int, int>, math::Correction>;  ///< by the position of, of

/// Largest error in the volume with these tables in the control, less that of its corner.
double worst(const Tables& tables) {
  const machine::Errors errors = volume_errors();
  const auto error = [&](const machine::Vector& p) {
    machine::Vector commanded = p;
    for (const auto& [axes, table] : tables) commanded[axes.second] += table(p[axes.first], 1);
    return machine::Vector(machine::point(errors, commanded) - p);
  };
  const machine::Vector corner = error({0, 0, 0});
  double most = 0.0;
  for (double x = 0.0; x < 0.81; x += 0.1)
    for (double y = 0.0; y < 0.61; y += 0.15)
      for (double z = 0.0; z < 0.51; z += 0.125)
        most = std::max(most, (error({x, y, z}) - corner).norm());
  return most;
}

void expect_diagonals_fall(const OutputResult& result, double to) {
  for (const char* diagonal : {"PPP", "NPP", "PNP", "PPN"}) {
    EXPECT_GT(prediction(result, diagonal).before, 10 * um) << diagonal;
    EXPECT_LT(prediction(result, diagonal).after, to) << diagonal;
  }
}

TEST(Cross, TablesOfStepDiagonalsStraightenTheVolume) {
  const double before = worst({});
  EXPECT_GT(before, 60 * um);
  for (const bool with_lengths : {true, false}) {
    const Bench bench = volume(with_lengths);
    const auto result = bench.write(siemens_plugin());
    ASSERT_TRUE(result) << result.error().message;
    const std::string cross = file(*result, "siemens-840d-XYZ-CEC.ini");
    Tables tables;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        const std::string in(1, "XYZ"[i]), out(1, "XYZ"[k]);
        const std::string pitch =
            file(*result, std::string("siemens-840d-") + "XYZ"[i] + "-EEC.ini");
        auto table = control_cross(siemens_plugin(), {{"", i == k ? pitch : cross}}, in, out);
        ASSERT_TRUE(table) << table.error().message;
        tables[{i, k}] = *table;
      }
    EXPECT_LT(worst(tables), 0.6 * um) << "before " << before;
    expect_diagonals_fall(*result, 0.3 * um);
    EXPECT_EQ(has_file(*result, "siemens-840d-X-backlash.ini"), with_lengths);
    // A sign that is wrong makes it worse.
    for (const auto& wrong : {std::pair{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}}) {
      Tables other = tables;
      other[wrong] = [right = tables[wrong]](double p, int d) { return -right(p, d); };
      EXPECT_GT(worst(other), 10 * um) << wrong.first << wrong.second;
    }
  }
}

TEST(Cross, HeidenhainColumnsOfTheVolume) {
  for (const char* layout : {"tnc640", "itnc530"})
    for (const bool with_lengths : {true, false}) {
      const auto result =
          volume(with_lengths).write(heidenhain_plugin(), {{"layout", std::string(layout)}});
      ASSERT_TRUE(result) << result.error().message;
      Tables tables;
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          const std::string com = file(*result, std::string("heidenhain-tnc-") + "XYZ"[i] + ".COM");
          const auto table = control_cross(heidenhain_plugin(), {{"", com}},
                                           std::string(1, "XYZ"[i]), std::string(1, "XYZ"[k]));
          ASSERT_TRUE(table) << table.error().message << com;
          tables[{i, k}] = *table;
        }
      EXPECT_LT(worst(tables), 0.8 * um) << layout;  // four decimals of a millimetre
      expect_diagonals_fall(*result, 0.5 * um);
    }
}

TEST(Cross, PitchOfStepDiagonalsGoesToEveryControl) {
  for (const Controller& output : {fanuc_plugin(), linuxcnc_plugin()}) {
    const Bench bench = volume(false);
    EXPECT_TRUE(output.applies(bench.campaign));
    const auto result =
        bench.write(output, output.info.name == "fanuc" ? Options{{"extended", true}} : Options{});
    ASSERT_TRUE(result) << output.info.name << ": " << result.error().message;
    EXPECT_GT(prediction(*result, "M").before, 10 * um) << output.info.name;
    EXPECT_LT(prediction(*result, "M").after, 2 * um) << output.info.name;
  }
}

/// Step diagonals alone: of each positioning they know the shape, not the scale.
TEST(Cross, ShapesOfStepDiagonalsAloneGiveThePitchTables) {
  Bench bench = volume(false);
  double worst_scale = 0.0;
  for (Series& s : bench.results.analyses.front().evaluation.series) {
    if (s.name[1] != s.name[2]) continue;
    const double first = s.value.front(), last = s.value.back();
    worst_scale += std::fabs(last - first);
    for (std::size_t i = 0; i <= steps; ++i)
      s.value[i] -= first + (last - first) * static_cast<double>(i) / steps;
    s.name += "_shape";
  }
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result) << result.error().message;
  for (const char* axis : {"X", "Y", "Z"}) {
    const std::string text = file(*result, std::string("siemens-840d-") + axis + "-EEC.ini");
    EXPECT_TRUE(contains(text, "NOT in the table: the scale of the axis")) << axis;
    EXPECT_NE(note(*result, "table.from-shape", axis), nullptr);
  }
  // What is left is the scales, straight lines along each diagonal.
  expect_diagonals_fall(*result, worst_scale + 0.3 * um);
  for (const Prediction& p : result->predictions) EXPECT_NE(p.name, "M");
  // A run of the axis in the same state makes the better table.
  bench.add({.axis = "X",
             .id = "X",
             .targets = even(0.0, travel[0] / steps, steps + 1),
             .plus = [](double p) { return 3 * um * p; },
             .minus = [](double p) { return 3 * um * p; }});
  const auto with_run = bench.write(siemens_plugin());
  ASSERT_TRUE(with_run) << with_run.error().message;
  EXPECT_FALSE(contains(file(*with_run, "siemens-840d-X-EEC.ini"), "the scale of the axis"));
}

TEST(Cross, EachStateOfAVolumeHasItsOwnColumns) {
  Bench bench = volume(true);
  Results::Analysed again = bench.results.analyses.front();
  again.measurement = "SD final";
  again.evaluation.uses.clear();
  for (Series& s : again.evaluation.series)
    for (double& v : s.value) v /= 10.0;
  bench.results.analyses.push_back(again);
  Measurement later = bench.campaign.measurements.back();
  later.id = again.measurement;
  bench.campaign.measurements.push_back(later);
  bench.observations.push_back(bench.observations.back());
  const auto result = bench.write(heidenhain_plugin());
  ASSERT_TRUE(result) << result.error().message;
  const auto y = [&](const std::string& name) {
    const auto table = control_cross(heidenhain_plugin(), {{"", file(*result, name)}}, "X", "Y");
    EXPECT_TRUE(table) << name;
    return table ? (*table)(0.4, 1) : 0.0;
  };
  EXPECT_GT(std::fabs(y("heidenhain-tnc-X-X.COM")), 2 * um);
  EXPECT_NEAR(y("heidenhain-tnc-X-SD_final.COM"), y("heidenhain-tnc-X-X.COM") / 10.0, 0.2 * um);
}

// Two digits of a dial of 10 um over 5 mm: in a cross table of diagonals, in one and in a pitch table of step diagonals.
TEST(Resolution, DigitsInCurvesOfDiagonalsAreNoTable) {
  const auto spoil = [](Series& s) {
    s.position[1] = s.position[0] + 5 * mm;
    s.value[1] = s.value[0] + 20 * um;
  };
  const auto refused = [](const OutputResult& r, const std::string& axis) {
    for (const Finding& f : r.findings)
      if (f.id == "table.refused-resolution" && f.texts.front().second == axis) return true;
    return false;
  };
  const auto in_digits = [](Observations& o) {
    for (double& d : o.deviation) d = 10 * um * std::round(d / (10 * um));
  };
  for (const bool steep : {false, true}) {
    Bench plane = gantry();
    plane.results.analyses.push_back(analysed(true));
    Measurement m;
    m.id = "D1", m.kind = "diagonal";
    plane.campaign.measurements.push_back(m);
    plane.observations.emplace_back();
    plane.observations.back().deviation = {0.0, 10 * um, 30 * um};
    if (steep) spoil(plane.results.analyses[0].evaluation.series[0]);
    const auto cross = plane.write(siemens_plugin());
    ASSERT_TRUE(cross) << cross.error().message;
    EXPECT_EQ(refused(*cross, "Y"), steep);
    EXPECT_EQ(has_file(*cross, "siemens-840d-XY-CEC.ini"), !steep);

    Bench whole = volume(false);
    in_digits(whole.observations.back());
    if (steep)
      for (Series& s : whole.results.analyses[0].evaluation.series)
        if (s.name == "EXX") spoil(s);
    const auto pitch = whole.write(siemens_plugin());
    ASSERT_TRUE(pitch) << pitch.error().message;
    EXPECT_EQ(refused(*pitch, "X"), steep);
    EXPECT_EQ(has_file(*pitch, "siemens-840d-X-EEC.ini"), !steep);
  }
}

}  // namespace

}  // namespace cross_test
