// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "one_output.h"

namespace nonio {
namespace {

using Vec = std::array<double, 3>;
constexpr double mm = 1e-3, deg = std::numbers::pi / 180.0;

Results::Analysed axis(const std::string& id, Vec centre, Vec direction,
                       std::vector<std::string> uses = {}) {
  Results::Analysed a{"rotary-kinematics", "1", id, {}};
  const double size = std::hypot(direction[0], direction[1], direction[2]);
  for (std::size_t k = 0; k < 3; ++k)
    a.evaluation.values.push_back(
        {std::string("centre_") + "xyz"[k], centre[k], Quantity::length, 1e-6});
  a.evaluation.values.push_back({"radius", 0.261, Quantity::length, 1e-6});
  for (std::size_t k = 0; k < 3; ++k)
    a.evaluation.values.push_back(
        {std::string("direction_") + "ijk"[k], direction[k] / size, Quantity::number, 5e-6});
  a.evaluation.uses = std::move(uses);
  return a;
}

Campaign campaign(const std::vector<std::string>& axes) {
  Campaign c;
  c.id = "one";
  for (const std::string& name : axes) {
    Measurement m;
    m.id = m.axis = name;
    m.kind = "ball-centres";
    c.measurements.push_back(m);
  }
  return c;
}

OutputResult write(const Campaign& c, std::vector<Results::Analysed> analyses,
                   std::map<std::string, Setting, std::less<>> options = {}) {
  Results results;
  results.analyses = std::move(analyses);
  options.emplace("limit_mm", 0.2);
  auto out = written(c, {}, results, {std::move(options)});
  EXPECT_TRUE(out);
  return out ? *out : OutputResult{};
}

std::string file(const OutputResult& result, std::string_view name) {
  for (const Artifact& a : result.artifacts)
    if (a.name == name) return a.bytes;
  return {};
}

bool says(const OutputResult& result, std::string_view id) {
  for (const Finding& f : result.findings)
    if (f.id == id) return true;
  return false;
}

double pin(const std::string& hal, const std::string& name) {
  const std::size_t at = hal.find("." + name + " ");
  EXPECT_NE(at, std::string::npos) << name;
  return at == std::string::npos ? NAN : std::stod(hal.substr(at + name.size() + 2)) * mm;
}

TEST(RotaryVectors, GenericFiles) {
  const auto out =
      write(campaign({"C"}), {axis("C", {0.4123456, 0.305, -0.1486}, {1.2e-4, -8e-5, 1})});
  const auto json = nlohmann::json::parse(file(out, "rotary-vectors.json"));
  EXPECT_EQ(json["axes"][0]["axis"], "C");
  EXPECT_DOUBLE_EQ(json["axes"][0]["centre_x"]["value"], 412.3456);
  EXPECT_EQ(json["axes"][0]["centre_x"]["unit"], "mm");
  EXPECT_DOUBLE_EQ(json["axes"][0]["centre_x"]["U"], 0.001);
  EXPECT_NEAR(json["axes"][0]["direction_i"]["value"], 1.2e-4, 1e-10);
  EXPECT_NE(file(out, "rotary-vectors.csv").find("C,C,centre_x,412.3456,mm,0.0010\n"),
            std::string::npos);
  EXPECT_NE(file(out, "rotary-vectors.txt").find("412.3456 +-   0.0010"), std::string::npos);
  EXPECT_EQ(out.artifacts.size(), 3U);  // one axis has no offsets
  EXPECT_TRUE(out.findings.empty());
}

TEST(RotaryVectors, SaysWhyThereIsNothing) {
  const auto out = write(campaign({"C"}), {{"rotary-kinematics", "1", "C", {}}});
  EXPECT_TRUE(out.artifacts.empty());
  EXPECT_TRUE(says(out, "vectors.none"));
}

TEST(RotaryVectors, OffsetsOnlyWithOneReference) {
  const Vec c{0.1, 0.2, -0.1}, b{0.11, 0.0, -0.3};
  const auto apart =
      write(campaign({"C", "B"}), {axis("C", c, {0, 0, 1}), axis("B", b, {0, 1, 0})});
  EXPECT_TRUE(says(apart, "vectors.no-reference"));
  EXPECT_EQ(apart.artifacts.size(), 3U);
  const auto wrong =
      write(campaign({"C", "B"}), {axis("C", c, {0, 0, -1}), axis("B", b, {0, 1, 0}, {"C"})});
  EXPECT_TRUE(says(wrong, "vectors.other-sense"));
  EXPECT_EQ(wrong.artifacts.size(), 5U);  // SINUMERIK and Fanuc take either sense
  EXPECT_NE(file(wrong, "rotary-vectors-fanuc.txt").find("19689"), std::string::npos);
  const auto across =
      write(campaign({"C", "B"}), {axis("C", c, {0, 1, 1}), axis("B", b, {0, 1, 0}, {"C"})});
  EXPECT_TRUE(says(across, "vectors.other-sense"));
  EXPECT_EQ(across.artifacts.size(), 3U);
  // An axis that was measured twice is not chosen from.
  auto twice = campaign({"C", "B"});
  twice.measurements.push_back(twice.measurements[0]);
  twice.measurements[2].id = "C again";
  const auto unclear = write(twice, {axis("C", c, {0, 0, 1}), axis("B", b, {0, 1, 0}, {"C"}),
                                     axis("C again", c, {0, 0, 1})});
  EXPECT_EQ(unclear.artifacts.size(), 3U);
}

Vec turned(const Vec& p, const Vec& about, std::size_t axis_of, double angle) {
  const std::size_t a = (axis_of + 1) % 3, b = (axis_of + 2) % 3;
  Vec out = p;
  const double x = p[a] - about[a], y = p[b] - about[b];
  out[a] = about[a] + std::cos(angle) * x - std::sin(angle) * y;
  out[b] = about[b] + std::sin(angle) * x + std::cos(angle) * y;
  return out;
}

/// The formulas of xyzbc-trt-kins and xyzac-trt-kins (from the work to the joints), as its source
/// has them, must put every point where a table with these lines carries it.
TEST(RotaryVectors, LinuxCncGoesWhereTheTableGoes) {
  for (const bool a : {false, true}) {
    const Vec c{0.4123, 0.30512, -0.1}, tilt{0.41226, 0.30519, -0.310045};
    const std::string name = a ? "A" : "B";
    const auto out =
        write(campaign({"C", name}),
              {axis("C", c, {0, 0, 1}), axis(name, tilt, a ? Vec{1, 0, 0} : Vec{0, 1, 0}, {"C"})});
    const std::string hal = file(out, "rotary-vectors-linuxcnc.hal");
    EXPECT_NE(hal.find(a ? "setp xyzac-trt-kins." : "setp xyzbc-trt-kins."), std::string::npos);
    const double xr = pin(hal, "x-rot-point"), yr = pin(hal, "y-rot-point"),
                 zr = pin(hal, "z-rot-point"), d = pin(hal, a ? "y-offset" : "x-offset"),
                 dz = pin(hal, "z-offset");
    for (const auto& [swivel, turn] : {std::pair(30.0, 50.0), {-60.0, 200.0}, {90.0, -10.0}}) {
      const Vec work{0.5, 0.25, -0.02};
      const double cs = std::cos(swivel * deg), sn = std::sin(swivel * deg);
      const double cc = std::cos(turn * deg), sc = std::sin(turn * deg);
      const double px = cc * (work[0] - xr) - sc * (work[1] - yr),
                   py = sc * (work[0] - xr) + cc * (work[1] - yr), pz = work[2] - zr;
      const Vec joints = a ? Vec{px + xr, cs * py - sn * pz - cs * d + sn * dz + d + yr,
                                 sn * py + cs * pz - sn * d - cs * dz + dz + zr}
                           : Vec{cs * px + sn * pz - cs * d - sn * dz + d + xr, py + yr,
                                 -sn * px + cs * pz + sn * d - cs * dz + dz + zr};
      const Vec real = turned(turned(work, c, 2, turn * deg), tilt, a ? 0 : 1, swivel * deg);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(joints[k], real[k], 0.2e-6) << name << k;
    }
  }
}

TEST(RotaryVectors, HeidenhainMarksWhatIsInferredOnceItsSignsWereShown) {
  const auto lines = [] {
    return std::vector<Results::Analysed>{axis("C", {0.1, 0.2, -0.1}, {0, 0, 1}),
                                          axis("B", {0.11, 0, -0.3}, {0, 1, 0}, {"C"})};
  };
  const auto hidden = write(campaign({"C", "B"}), lines());
  EXPECT_TRUE(says(hidden, "vectors.sign-not-shown"));
  EXPECT_TRUE(file(hidden, "rotary-vectors-heidenhain.txt").empty());
  const auto out = write(campaign({"C", "B"}), lines(),
                         {{"sign_shown", std::vector<std::string>{"heidenhain"}}});
  const std::string table = file(out, "rotary-vectors-heidenhain.txt");
  EXPECT_NE(table.find("INFERRED"), std::string::npos);
  EXPECT_NE(table.find("Trans     X     110.0000\nTrans     Y     200.0000\n"
                       "Trans     Z     -300.0000\nMachAxis  B\nTrans     X     -10.0000\n"),
            std::string::npos)
      << table;
}

/// Both lines as one analysis gives them.
Results::Analysed chain(const std::string& tables, const std::string& heads) {
  Results::Analysed a{"rotary-chain", "1", "BC", {}};
  for (const auto& [name, line] :
       {std::pair(std::string("C"), axis("", {0.1, 0.2, -0.1}, {0, 0, 1})),
        std::pair(std::string("B"), axis("", {0.11, 0, -0.3}, {0, 1, 0}))})
    for (Value v : line.evaluation.values) {
      v.name += "_" + name;
      a.evaluation.values.push_back(v);
    }
  if (!tables.empty())
    a.evaluation.notes.push_back({"rotary-chain.tables", {}, {{"axes", tables}}});
  if (!heads.empty()) a.evaluation.notes.push_back({"rotary-chain.heads", {}, {{"axes", heads}}});
  return a;
}

TEST(RotaryVectors, OneFitOfBothIsTakenBeforeTheFitsOfEach) {
  Campaign c = campaign({"C"});
  for (const char* name : {"B", "C"}) {
    c.machine.axes.push_back(Axis{.name = name});
    c.machine.axes.back().rotary = true;
  }
  const auto out = write(c, {axis("C", {0.3, 0.3, 0.3}, {0, 0, 1}), chain("B, C", "")});
  const auto json = nlohmann::json::parse(file(out, "rotary-vectors.json"));
  ASSERT_EQ(json["axes"].size(), 2U);
  EXPECT_EQ(json["axes"][0]["axis"], "B");
  EXPECT_DOUBLE_EQ(json["axes"][1]["centre_x"]["value"], 100.0);
  EXPECT_FALSE(json["axes"][1].contains("seen_from"));
  const std::string fanuc = file(out, "rotary-vectors-fanuc.txt");
  EXPECT_NE(fanuc.find("both at 0, from one fit"), std::string::npos);
  EXPECT_DOUBLE_EQ(pin(file(out, "rotary-vectors-linuxcnc.hal"), "x-offset"), 0.01);
  for (const auto& [tables, heads] :
       {std::pair("C, B", ""), std::pair("C", "B"), std::pair("", "C, B")}) {
    const auto other = write(c, {chain(tables, heads)});
    EXPECT_TRUE(says(other, "vectors.other-chain")) << tables;
    EXPECT_EQ(other.artifacts.size(), 3U);
    const auto axes = nlohmann::json::parse(file(other, "rotary-vectors.json"))["axes"];
    EXPECT_EQ(axes[0].contains("seen_from"), std::string(heads).find('B') != std::string::npos);
  }
}

/// Value of a row "  name before new change", by its column.
double number(const std::string& text, const std::string& name, int column) {
  const std::size_t at = text.find("  " + name + " ");
  EXPECT_NE(at, std::string::npos) << name << "\n" << text;
  if (at == std::string::npos) return NAN;
  std::istringstream row(text.substr(at + 2 + name.size()));
  std::string word;
  for (int i = 0; i <= column; ++i) row >> word;
  return std::stod(word);
}

/// I2 + I3 + I4 = 0, and the axes pass through I2 and I2 + I3: an exactly turned point goes where
/// these vectors take it.
TEST(RotaryVectors, SiemensAndFanucVectorsAreTheAxes) {
  const Vec c{0.4123, 0.30512, -0.1}, tilt{0.41226, 0.1, -0.310045};
  const auto out =
      write(campaign({"C", "B"}), {axis("C", c, {0, 0, 1}), axis("B", tilt, {0, 1, 0}, {"C"})});
  const std::string siemens = file(out, "rotary-vectors-siemens.txt"),
                    fanuc = file(out, "rotary-vectors-fanuc.txt");
  EXPECT_EQ(siemens.find("TC_CARR7 "), std::string::npos) << "the sign of V1 is not shown";
  EXPECT_TRUE(says(out, "vectors.sign-not-shown"));
  constexpr int new_one = 2;  // behind "not stated"
  Vec first{}, second{}, closing{};
  for (std::size_t k = 0; k < 3; ++k) {
    first[k] = number(siemens, "$TC_CARR" + std::to_string(4 + k), new_one) * mm;
    second[k] = number(siemens, "$TC_CARR" + std::to_string(15 + k), new_one) * mm;
    closing[k] = number(siemens, "$TC_CARR" + std::to_string(18 + k), new_one) * mm;
    EXPECT_NEAR(first[k] + second[k] + closing[k], 0.0, 0.3e-6);
    EXPECT_NEAR(number(fanuc, std::to_string(19700 + k), new_one) * mm, first[k], 1e-9);
    EXPECT_NEAR(number(fanuc, std::to_string(19703 + k), new_one) * mm, second[k], 1e-9);
  }
  const Vec meeting{first[0] + second[0], first[1] + second[1], first[2] + second[2]};
  for (const double angle : {25.0, 110.0}) {
    const Vec point{0.5, 0.25, -0.02};
    const Vec by_c = turned(point, meeting, 2, angle * deg),
              real_c = turned(point, c, 2, angle * deg);
    const Vec by_b = turned(point, first, 1, angle * deg),
              real_b = turned(point, tilt, 1, angle * deg);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(by_c[k], real_c[k], 0.3e-6);
      EXPECT_NEAR(by_b[k], real_b[k], 0.3e-6);
    }
  }
  EXPECT_EQ(number(fanuc, "19684", new_one), 0.0);
}

TEST(RotaryVectors, ChangesHaveALimitAndALog) {
  const auto lines = [] {
    return std::vector<Results::Analysed>{axis("C", {0.1, 0.2, -0.1}, {0, 0, 1}),
                                          axis("B", {0.11, 0, -0.3}, {0, 1, 0}, {"C"})};
  };
  const auto with = [&](double was, const char* name = "19700") {
    return write(campaign({"C", "B"}), lines(),
                 {{"before", NumberTables{{"fanuc", {{name, was}}}}}});
  };
  const auto good = with(109.95);
  const std::string log = file(good, "rotary-vectors-changes.txt");
  EXPECT_DOUBLE_EQ(number(log, "19700", 0), 109.95);
  EXPECT_DOUBLE_EQ(number(log, "19700", 1), 110.0);
  EXPECT_DOUBLE_EQ(number(log, "19700", 2), 0.05);
  const auto large = with(109.5);
  EXPECT_TRUE(says(large, "vectors.change-too-large"));
  EXPECT_TRUE(file(large, "rotary-vectors-fanuc.txt").empty());
  EXPECT_FALSE(file(large, "rotary-vectors-siemens.txt").empty());
  EXPECT_TRUE(says(with(110.0, "19707"), "vectors.unknown-name"));
}

}  // namespace
}  // namespace nonio
