// SPDX-License-Identifier: Apache-2.0
#include <clocale>
#include <locale>
#include <numbers>

#include "nonio/sdk/format.h"
#include "workshop.h"

namespace every_table_test {

using namespace workshop;

namespace {

struct Kind {
  const char* name;
  Controller (*output)();
  Options options;
  double resolution;  // of the table, m
};

std::vector<Kind> kinds() {
  return {{"siemens-840d", siemens_plugin, {}, 1e-9},
          {"heidenhain-tnc", heidenhain_plugin, {}, 1e-7},
          {"heidenhain-tnc", heidenhain_plugin, {{"layout", std::string("itnc530")}}, 1e-7},
          {"fanuc", fanuc_plugin, {{"extended", true}}, 1e-6},
          {"linuxcnc", linuxcnc_plugin, {}, 1e-10},
          {"linuxcnc", linuxcnc_plugin, {{"type", std::int64_t{1}}}, 1e-10}};
}

std::vector<Kind> with_directions() {
  return {{"siemens-840d", siemens_plugin, {{"directions", true}}, 1e-9},
          {"heidenhain-tnc", heidenhain_plugin, {{"directions", true}}, 1e-7},
          {"fanuc", fanuc_plugin, {{"directions", true}, {"extended", true}}, 1e-6},
          {"linuxcnc", linuxcnc_plugin, {}, 1e-10}};
}

Measured random_axis(std::mt19937& random, bool elastic) {
  Measured m;
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  m.targets = even(std::round(u(random) * 100) * mm, 40 * mm, 21);
  m.plus = random_curve(random, 0.8, 12 * um);
  const double B = -3 * um + 2 * um * u(random);
  const Curve wave = random_curve(random, 0.8, elastic ? 6 * um : 0.0);
  m.minus = [p = m.plus, B, wave](double x) { return p(x) - B + wave(x); };
  m.runs = 3;
  m.scatter = 0.05 * um;
  m.seed = static_cast<std::uint32_t>(random());
  return m;
}

// A swing in the reversal far over its scatter, mean near zero.
Measured elastic_axis() {
  Measured m;
  m.targets = even(0.0, 50 * mm, 11);
  m.plus = [](double x) { return 5 * um * std::sin(12 * x); };
  m.minus = [](double x) { return -5 * um * std::sin(12 * x) + 0.2 * um; };
  m.runs = 5;
  m.scatter = 0.2 * um;
  return m;
}

std::string flipped(std::string text, char after) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    out += text[i];
    if (text[i] == after && i + 1 < text.size()) {
      if (text[i + 1] == '-') {
        ++i;
      } else if (text[i + 1] >= '0' && text[i + 1] <= '9') {
        out += '-';
      }
    }
  }
  return out;
}

const std::string X_comp = "linuxcnc-X.comp";

double E_after(const math::ErrorCurve& curve, const Expected<math::Correction>& c) {
  EXPECT_TRUE(c) << (c ? "" : c.error().message);
  return c ? math::after(curve, *c).E() : 0.0;
}

}  // namespace

TEST(EveryTable, TakesTheErrorAway) {
  const std::uint32_t seed = 230214;
  print_seed(seed);
  for (const Kind& k : kinds()) {
    std::mt19937 random(seed);
    const Controller output = k.output();
    for (int round = 0; round < 25; ++round) {
      const Bench b(random_axis(random, false));
      const auto r = b.write(output, k.options);
      ASSERT_TRUE(r) << k.name << ": " << r.error().message << ", seed " << seed;
      const auto curve = curve_of(b);
      const Prediction& E = prediction(*r, "E");
      // what one backlash value leaves of the scatter, and the table's own steps
      double left = 0.0;
      for (std::size_t i = 0; i < curve.position.size(); ++i)
        left = std::max(left, std::fabs(curve.plus[i] - curve.minus[i] - curve.mean_reversal()));
      if (std::string_view(k.name) == "linuxcnc") left = std::max(left, U_of_largest_reversal(b));
      EXPECT_LE(E.after, left + 2.5 * k.resolution + 0.01 * um)
          << k.name << ", seed " << seed << ", round " << round;
      EXPECT_LT(E.after, 0.5 * E.before) << k.name << ", seed " << seed << ", round " << round;
      EXPECT_EQ(finding(*r, "table.no-gain"), nullptr);
    }
  }
}

// Scatter of the size of the reversal: one value for the whole axis may leave more than there was.
TEST(EveryTable, NoBacklashValueMakesTheLargestReversalLarger) {
  const std::uint32_t seed = 1401560;
  print_seed(seed);
  for (const Kind& k : kinds()) {
    std::mt19937 random(seed);
    int left_alone = 0;
    for (int round = 0; round < 150; ++round) {
      Measured axis = random_axis(random, false);
      axis.targets = even(0.0, 60 * mm, 7);
      axis.minus = [p = axis.plus](double x) { return p(x) + 0.3 * um; };
      axis.runs = 3;
      axis.scatter = 0.9 * um;
      const auto r = Bench(axis).write(k.output(), k.options);
      ASSERT_TRUE(r) << k.name << ", seed " << seed;
      if (r->artifacts.empty()) continue;  // refused
      const Finding* alone = finding(*r, "table.backlash-no-gain");
      if (alone == nullptr) alone = finding(*r, "table.backlash-not-identifiable");
      left_alone += alone != nullptr ? 1 : 0;
      const Prediction& B = prediction(*r, "B");
      if (k.name == std::string("linuxcnc")) continue;  // its columns hold each direction
      EXPECT_LE(B.after, B.before + 2.5 * k.resolution)
          << k.name << ", seed " << seed << ", round " << round;
    }
    EXPECT_GT(left_alone, 0) << k.name;
  }
}

TEST(EveryTable, DirectionTablesTakeAnElasticReversalAwayToo) {
  const std::uint32_t seed = 3441;
  print_seed(seed);
  for (const Kind& k : with_directions()) {
    std::mt19937 random(seed);
    const Controller output = k.output();
    for (int round = 0; round < 25; ++round) {
      const Bench b(random_axis(random, true));
      const auto r = b.write(output, k.options);
      ASSERT_TRUE(r) << k.name << ": " << r.error().message << ", seed " << seed;
      const double U = U_of_largest_reversal(b);  // no prediction is better
      EXPECT_LE(prediction(*r, "E").after, std::max(U, 2.5 * k.resolution + 0.01 * um))
          << k.name << ", seed " << seed << ", round " << round;
      EXPECT_LE(prediction(*r, "B").after, std::max(U, 2.5 * k.resolution + 0.01 * um));
      EXPECT_GE(prediction(*r, "B").after, std::min(U, prediction(*r, "B").before) * (1 - 1e-9));
    }
  }
}

TEST(EveryTable, UnevenTargetsAreInterpolatedWell) {
  const std::uint32_t seed = 77;
  print_seed(seed);
  for (const Kind& k : kinds()) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(-0.3, 0.3);
    Measured m = random_axis(random, false);
    for (double& x : m.targets) x += std::round(u(random) * 40e3) * 1e-6;
    const auto r = Bench(m).write(k.output(), k.options);
    ASSERT_TRUE(r) << k.name << ": " << r.error().message;
    EXPECT_LT(prediction(*r, "E").after, 0.1 * prediction(*r, "E").before + 2.5 * k.resolution)
        << k.name << ", seed " << seed;
  }
}

TEST(EveryTable, IsRefusedWhereOneValueCannotHelp) {
  for (const auto& output : {siemens_plugin(), heidenhain_plugin(), fanuc_plugin()}) {
    const Bench b(elastic_axis());
    const auto r = b.write(output);
    ASSERT_TRUE(r) << r.error().message;
    EXPECT_TRUE(r->artifacts.empty()) << output.info.name;
    EXPECT_TRUE(r->predictions.empty());
    const Finding* f = finding(*r, "table.refused-reversal");
    ASSERT_NE(f, nullptr) << output.info.name;
    EXPECT_TRUE(f->attention);
    EXPECT_EQ(f->measurement, "X");
    ASSERT_EQ(f->evidence.size(), 2U);
    EXPECT_EQ(f->evidence[0].name, "mean");
    EXPECT_NEAR(f->evidence[0].value, -0.2 * um, 1 * um);
    EXPECT_NEAR(f->evidence[1].value, 10 * um, 1 * um);
    EXPECT_EQ(f->evidence[1].quantity, Quantity::deviation);
    const auto wished = b.write(output, {{"directions", true}});
    ASSERT_TRUE(wished) << wished.error().message;
    EXPECT_FALSE(wished->artifacts.empty());
  }
}

// One axis refused leaves the other's table alone.
TEST(EveryTable, RefusalIsOfOneAxis) {
  for (const auto& output : {siemens_plugin(), heidenhain_plugin(), fanuc_plugin()}) {
    Bench b(elastic_axis());
    std::mt19937 random(5);
    Measured y = random_axis(random, false);
    y.axis = y.id = "Y";
    b.add(y);
    const auto r = b.write(output, {{"axes", std::vector<std::string>{}}});
    ASSERT_TRUE(r) << r.error().message;
    EXPECT_NE(finding(*r, "table.refused-reversal"), nullptr);
    for (const Prediction& p : r->predictions) EXPECT_EQ(p.measurement, "Y");
    EXPECT_FALSE(r->artifacts.empty());
  }
}

TEST(EveryTable, StatesADriftThatDoesNotWithholdIt) {
  for (const Kind& k : kinds()) {
    std::mt19937 random(9);
    Measured axis = random_axis(random, false);
    axis.runs = 5;
    Bench b(axis);
    const auto drifted = [&] {
      const auto r = b.write(k.output(), k.options);
      EXPECT_TRUE(r && !r->artifacts.empty()) << k.name;
      return r && std::any_of(r->notes.begin(), r->notes.end(),
                              [](const Remark& note) { return note.id == "table.drifted"; });
    };
    EXPECT_FALSE(drifted()) << k.name;
    Observations& o = b.observations[0];
    for (std::size_t i = 0; i < o.size(); ++i) o.deviation[i] += 0.3 * um * o.run[i];
    EXPECT_TRUE(drifted()) << k.name;
  }
}

// Without any analysis: the readings themselves say it.
TEST(EveryTable, RefusesDriftUnlessAskedFor) {
  for (const Kind& k : kinds()) {
    std::mt19937 random(9);
    Measured axis = random_axis(random, false);
    axis.runs = 5;
    Bench b(axis);
    const auto calm = b.write(k.output(), k.options);
    ASSERT_TRUE(calm);
    EXPECT_EQ(finding(*calm, "table.unstable-axis"), nullptr) << k.name;
    EXPECT_EQ(finding(*calm, "table.refused-drift"), nullptr) << k.name;
    EXPECT_FALSE(calm->artifacts.empty()) << k.name;
    Observations& o = b.observations[0];
    for (std::size_t i = 0; i < o.size(); ++i) o.deviation[i] += 3 * um * o.run[i];
    const auto none = b.write(k.output(), k.options);
    ASSERT_TRUE(none);
    EXPECT_TRUE(none->artifacts.empty()) << k.name;
    const Finding* refused = finding(*none, "table.refused-drift");
    ASSERT_NE(refused, nullptr) << k.name;
    EXPECT_TRUE(refused->attention);
    EXPECT_TRUE(contains(refused->advice, "drifted = 1")) << refused->advice;
    Options asked = k.options;
    asked["axes"] = std::vector<std::string>{"X drifted=1"};
    const auto r = b.write(k.output(), asked);
    ASSERT_TRUE(r);
    const Finding* f = finding(*r, "table.unstable-axis");
    ASSERT_NE(f, nullptr) << k.name;
    EXPECT_TRUE(f->attention);
    EXPECT_TRUE(contains(f->advice, "Do not compensate yet")) << f->advice;
    bool warned = false;
    for (const Artifact& artifact : r->artifacts)
      warned = warned || contains(artifact.bytes, "WARNING: the axis drifted");
    EXPECT_TRUE(warned) << k.name;
  }
}

TEST(EveryTable, WarnsOfSuspectReadings) {
  for (const Kind& k : kinds()) {
    std::mt19937 random(9);
    Bench b(random_axis(random, false));
    const auto calm = b.write(k.output(), k.options);
    ASSERT_TRUE(calm);
    EXPECT_EQ(finding(*calm, "table.suspect-reading"), nullptr) << k.name;
    Observations& o = b.observations[0];
    const std::size_t wild = o.size() - 5;  // run 3, the last pass
    o.deviation[wild] += 20 * um;
    const auto r = b.write(k.output(), k.options);
    ASSERT_TRUE(r);
    const Finding* f = finding(*r, "table.suspect-reading");
    ASSERT_NE(f, nullptr) << k.name;
    EXPECT_TRUE(f->attention);
    EXPECT_EQ(f->evidence.at(0).value, 1.0) << k.name;
    const std::string which = fixed_text(o.axes[0].position[wild] / mm, 1) + " mm (3, -)";
    EXPECT_EQ(f->texts.at(1).second, which);
    bool warned = false;
    for (const Artifact& artifact : r->artifacts)
      warned = warned ||
               contains(artifact.bytes, "WARNING: the table contains suspect readings at " + which);
    EXPECT_TRUE(warned) << k.name;
    EXPECT_EQ(r->predictions.size(), 3U) << k.name;
  }
}

// The order of axes in the manifest does not give their numbers in the control.
TEST(EveryTable, NumberIsNeverGuessed) {
  std::mt19937 random(11);
  Bench b(random_axis(random, false));
  b.numbered = false;
  for (const Controller& output : {siemens_plugin(), fanuc_plugin()}) {
    const auto r = b.write(output);
    ASSERT_TRUE(r) << output.info.name;
    EXPECT_TRUE(r->artifacts.empty()) << output.info.name;
    const Finding* f = finding(*r, "table.axis-number");
    ASSERT_NE(f, nullptr) << output.info.name;
    EXPECT_TRUE(f->attention);
    EXPECT_TRUE(contains(f->advice, "[axes.X] of machines/<asset>.toml"));
  }
  for (const Controller& output : {heidenhain_plugin(), linuxcnc_plugin()}) {
    const auto r = b.write(output);
    ASSERT_TRUE(r) << output.info.name;
    EXPECT_FALSE(r->artifacts.empty()) << output.info.name;
  }
  EXPECT_FALSE(contains(file(*b.write(linuxcnc_plugin()), "linuxcnc-X.ini"), "[JOINT_"));
}

// A mistake in option `axes` names the option, of which the host knows the line.
TEST(EveryTable, SaysThatOptionAxesIsToBlame) {
  for (const Kind& k : kinds())
    for (const char* entry : {"Q step_mm=1", "X wrong_mm=1"}) {
      std::mt19937 random(9);
      Options options = k.options;
      options["axes"] = std::vector<std::string>{entry};
      const auto r = Bench(random_axis(random, false)).write(k.output(), options);
      ASSERT_FALSE(r) << k.name << entry;
      EXPECT_EQ(r.error().key, entry[0] == 'Q' ? "axes.Q" : "axes.X.wrong_mm") << k.name << entry;
    }
}

// B = -10 um -/+ the swing: of 4 um one value leaves 4 of 14, of 2 um only 2 of 12.
TEST(EveryTable, SaysWhatOneValueLeavesOfAnUnevenReversal) {
  for (const Kind& k : kinds())
    for (const double swing : {4 * um, 2 * um}) {
      Measured m;
      m.targets = even(0.0, 50 * mm, 9);
      m.plus = [](double) { return 0.0; };
      m.minus = [swing](double x) {
        return 10 * um + swing * std::cos(x / (50 * mm) * std::numbers::pi / 2);
      };
      m.runs = 5;
      m.scatter = 0.05 * um;
      Bench b(m);
      const auto r = b.write(k.output(), k.options);
      ASSERT_TRUE(r) << r.error().message;
      const Finding* f = finding(*r, "table.uneven-reversal");
      const bool one_value = std::string(k.name) != "linuxcnc";  // its columns have both
      ASSERT_EQ(f != nullptr, one_value && swing > 3 * um) << k.name;
      EXPECT_EQ(r->predictions.size(), 3U) << k.name;
      if (f == nullptr) continue;
      EXPECT_TRUE(f->attention);
      EXPECT_EQ(f->evidence.at(0).name, "mean");
      EXPECT_NEAR(f->evidence[0].value, -10.5 * um, 0.6 * um);
      EXPECT_EQ(f->evidence.at(1).name, "left");
      EXPECT_NEAR(f->evidence[1].value, 4 * um, 0.6 * um);
    }
  for (const Kind& k : with_directions()) {
    Measured m;
    m.targets = even(0.0, 50 * mm, 9);
    m.plus = [](double) { return 0.0; };
    m.minus = [](double x) {
      return 10 * um + 4 * um * std::cos(x / (50 * mm) * std::numbers::pi / 2);
    };
    m.runs = 5;
    m.scatter = 0.05 * um;
    const auto r = Bench(m).write(k.output(), k.options);
    ASSERT_TRUE(r) << r.error().message;
    EXPECT_EQ(finding(*r, "table.uneven-reversal"), nullptr) << k.name;
  }
}

TEST(EveryTable, BeforeAndAfterHaveTheirOwnFiles) {
  for (const Kind& k : kinds()) {
    std::mt19937 random(11);
    Measured first = random_axis(random, false), second = random_axis(random, false);
    first.id = "X-before";
    second.id = "../X after";
    Bench b(first);
    b.add(second);
    const auto r = b.write(k.output(), k.options);
    ASSERT_TRUE(r) << r.error().message;
    EXPECT_NE(finding(*r, "table.two-measurements"), nullptr);
    std::map<std::string, int> names;
    for (const Artifact& a : r->artifacts) {
      EXPECT_EQ(++names[a.name], 1) << a.name;
      EXPECT_EQ(a.name.rfind(std::string(k.name) + "-", 0), 0U) << a.name;
      EXPECT_EQ(a.name.find('/'), std::string::npos) << a.name;
    }
    EXPECT_EQ(r->predictions.size(), 6U);
  }
}

TEST(EveryTable, OneDirectionOnly) {
  for (const Kind& k : kinds()) {
    std::mt19937 random(13);
    Measured m = random_axis(random, false);
    m.plus = {};
    const auto r = Bench(m).write(k.output(), k.options);
    ASSERT_TRUE(r) << k.name << ": " << r.error().message;
    ASSERT_EQ(r->predictions.size(), 1U) << k.name;
    EXPECT_EQ(r->predictions[0].name, "E-");
    EXPECT_LT(r->predictions[0].after, 2.5 * k.resolution + 0.01 * um);
    for (const Artifact& a : r->artifacts) {
      EXPECT_FALSE(contains(a.bytes, "MA_BACKLASH")) << k.name;
      EXPECT_FALSE(contains(a.bytes, "backLash =")) << k.name;
      EXPECT_FALSE(contains(a.bytes, "N1851")) << k.name;
    }
  }
}

// A control that compensates 10 um already, and still 3 um lost: 13 um go into the parameter.
TEST(EveryTable, PresentBacklashIsCounted) {
  Measured m;
  m.targets = even(0.0, 50 * mm, 11);
  m.plus = [](double x) { return 5 * um * std::sin(12 * x); };
  m.minus = [p = m.plus](double x) { return p(x) + 3 * um; };
  const Bench b(m);
  const Setting present = std::vector<std::string>{"X backlash_mm=0.010"};
  auto all = kinds();
  for (const Kind& k : with_directions()) all.push_back(k);
  for (Kind& k : all) {
    k.options["axes"] = present;
    const auto r = b.write(k.output(), k.options);
    ASSERT_TRUE(r) << k.name << ": " << r.error().message;
    EXPECT_LE(prediction(*r, "E").after, 2.5 * k.resolution + 0.01 * um) << k.name;
    EXPECT_NEAR(prediction(*r, "B").before, 3 * um, 1e-12);
  }
  const auto s = b.write(siemens_plugin(), {{"axes", present}});
  EXPECT_TRUE(contains(file(*s, "siemens-840d-X-backlash.ini"), "$MA_BACKLASH[0,AX1]=0.013\n"));
  const auto f = b.write(fanuc_plugin(), {{"axes", present}});
  EXPECT_TRUE(contains(file(*f, "fanuc-X.prm"), "N1851A1P13\n"));
  const auto h = b.write(heidenhain_plugin(), {{"axes", present}});
  EXPECT_TRUE(contains(file(*h, "heidenhain-tnc-X.txt"), "backLash = +0.0130\n"));
  // LinuxCNC ignores BACKLASH if there is a table: -5 um of it go into one column, +5 into the other
  const auto l = b.write(linuxcnc_plugin(), {{"axes", present}});
  EXPECT_EQ(lines(file(*l, "linuxcnc-X.comp"))[0], "0.00000000 -0.00650000 0.00650000");
}

// Over-travel at reversal: nearly always a value that is too large already.
TEST(EveryTable, PositiveReversalIsDoubted) {
  Measured m;
  m.targets = even(0.0, 50 * mm, 11);
  m.plus = [](double) { return 4 * um; };
  m.minus = [](double) { return 0.0; };
  m.runs = 5;
  m.scatter = 0.1 * um;
  for (const auto& output : {siemens_plugin(), heidenhain_plugin(), fanuc_plugin()}) {
    const auto r = Bench(m).write(output);
    ASSERT_TRUE(r);
    const Finding* f = finding(*r, "table.positive-reversal");
    ASSERT_NE(f, nullptr) << output.info.name;
    EXPECT_NEAR(f->evidence[0].value, 4 * um, 0.2 * um);
    const auto said =
        Bench(m).write(output, {{"axes", std::vector<std::string>{"X backlash_mm=0.006"}}});
    ASSERT_TRUE(said);
    EXPECT_EQ(finding(*said, "table.positive-reversal"), nullptr);
  }
}

TEST(EveryTable, StraightnessAndEmptyMeasurementsAreNotPitch) {
  for (const Kind& k : kinds()) {
    std::mt19937 random(15);
    Bench b(random_axis(random, false));
    b.campaign.measurements[0].kind = "straightness";
    EXPECT_FALSE(k.output().applies(b.campaign));
    const auto r = b.write(k.output(), k.options);
    ASSERT_TRUE(r);
    EXPECT_TRUE(r->artifacts.empty());
    b.campaign.measurements[0].kind = "axis";
    EXPECT_TRUE(k.output().applies(b.campaign));
    b.observations[0] = {};
    const auto empty = b.write(k.output(), k.options);
    ASSERT_TRUE(empty);
    EXPECT_TRUE(empty->artifacts.empty());
  }
}

TEST(EveryTable, SettingsOfOneAxisAreChecked) {
  const Bench b(elastic_axis());
  const auto message = [&](const char* entry) {
    const auto r = b.write(siemens_plugin(), {{"axes", std::vector<std::string>{entry}}});
    return r ? std::string("taken") : r.error().message;
  };
  EXPECT_TRUE(contains(message("Q step_mm=5"), "no axis Q; there are X"));
  EXPECT_TRUE(contains(message("X stepp_mm=5"), "no setting stepp_mm; there are"));
  EXPECT_TRUE(contains(message("X number=1.5"), "whole number"));
  EXPECT_TRUE(contains(message("X backlash=1"), "no setting backlash;"));
}

struct CommaEverywhere : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(EveryTable, NumbersDoNotKnowTheLocale) {
  for (const Kind& k : kinds()) {
    std::mt19937 random(17);
    const Bench b(random_axis(random, false));
    const auto plain = b.write(k.output(), k.options);
    const std::locale before = std::locale::global(std::locale(std::locale(), new CommaEverywhere));
    const char* german = std::setlocale(LC_ALL, "de_DE.UTF-8");  // may not be installed
    const auto comma = b.write(k.output(), k.options);
    std::locale::global(before);
    if (german != nullptr) std::setlocale(LC_ALL, "C");
    ASSERT_TRUE(plain);
    ASSERT_TRUE(comma);
    ASSERT_EQ(plain->artifacts.size(), comma->artifacts.size());
    for (std::size_t i = 0; i < plain->artifacts.size(); ++i)
      EXPECT_EQ(plain->artifacts[i].bytes, comma->artifacts[i].bytes) << k.name;
  }
}

// The models are worth something only if they see what is wrong.
TEST(EveryModel, SeesAFlippedSign) {
  std::mt19937 random(19);
  const Bench b(random_axis(random, false));
  const auto curve = curve_of(b);
  const double was = math::before(curve).E();

  const auto s = b.write(siemens_plugin());
  const std::string eec = file(*s, "siemens-840d-X-EEC.ini");
  EXPECT_LT(E_after(curve, control(siemens_plugin(), {{"", eec}})), was);
  std::string wrong;
  for (const std::string& line : lines(eec))
    wrong += (line.rfind("$AA_ENC_COMP[", 0) == 0 ? flipped(line, '=') : line) + "\n";
  EXPECT_GT(E_after(curve, control(siemens_plugin(), {{"", wrong}})), was);

  const auto f = b.write(fanuc_plugin(), {{"extended", true}});
  const Options extended{{"extended", true}};
  const std::string prm = file(*f, "fanuc-X.prm");
  EXPECT_LT(E_after(curve, control(fanuc_plugin(), {{"", prm}}, extended)), was);
  wrong.clear();
  for (const std::string& line : lines(prm))
    wrong += (line.rfind("N1", 0) == 0 && line.size() > 6 && line[2] == '0' ? flipped(line, 'P')
                                                                            : line) +
             "\n";
  EXPECT_GT(E_after(curve, control(fanuc_plugin(), {{"", wrong}}, extended)), was);

  const Options type_1{{"type", std::int64_t{1}}};
  const auto l = b.write(linuxcnc_plugin(), type_1);
  const std::string comp = file(*l, "linuxcnc-X.comp");
  EXPECT_LT(E_after(curve, control(linuxcnc_plugin(), {{X_comp, comp}}, type_1)), was / 100);
  EXPECT_GT(E_after(curve, control(linuxcnc_plugin(), {{X_comp, flipped(comp, ' ')}}, type_1)),
            was);

  const auto h = b.write(heidenhain_plugin());
  std::string com = file(*h, "heidenhain-tnc-X.COM");
  EXPECT_LT(E_after(curve, control(heidenhain_plugin(), {{"", com}})), was);
  wrong.clear();
  for (std::string line : lines(com)) {
    if (line.size() > 33 && (line[33] == '+' || line[33] == '-'))
      line[33] = line[33] == '+' ? '-' : '+';
    wrong += line + "\n";
  }
  EXPECT_GT(E_after(curve, control(heidenhain_plugin(), {{"", wrong}})), was);
}

TEST(EveryModel, SeesSwappedDirections) {
  const Bench b(elastic_axis());
  const auto curve = curve_of(b);
  const double was = math::before(curve).B();
  const auto B_after = [&](const Expected<math::Correction>& c) {
    EXPECT_TRUE(c) << (c ? "" : c.error().message);
    return c ? math::after(curve, *c).B() : 0.0;
  };
  const auto s = b.write(siemens_plugin(), {{"directions", true}});
  std::string cec = file(*s, "siemens-840d-X-CEC.ini");
  EXPECT_LT(B_after(control(siemens_plugin(), {{"", cec}})), was / 100);
  const std::size_t one = cec.find("DIRECTION[0]=1"), two = cec.find("DIRECTION[1]=-1");
  cec.replace(two, 15, "DIRECTION[1]=1");
  cec.replace(one, 14, "DIRECTION[0]=-1");
  EXPECT_GT(B_after(control(siemens_plugin(), {{"", cec}})), 1.5 * was);

  const auto l = b.write(linuxcnc_plugin());
  std::string swapped;
  for (const std::string& line : lines(file(*l, "linuxcnc-X.comp"))) {
    const std::size_t i = line.find(' '), j = line.find(' ', i + 1);
    swapped += line.substr(0, i) + line.substr(j) + line.substr(i, j - i) + "\n";
  }
  EXPECT_GT(B_after(control(linuxcnc_plugin(), {{X_comp, swapped}})), 1.5 * was);
}

// MD32450 of the wrong sign doubles the lost motion.
TEST(EveryModel, SeesAWrongBacklashSign) {
  std::mt19937 random(23);
  const Bench b(random_axis(random, false));
  const auto curve = curve_of(b);
  const auto s = b.write(siemens_plugin());
  const std::string eec = file(*s, "siemens-840d-X-EEC.ini");
  const std::string md = file(*s, "siemens-840d-X-backlash.ini");
  ASSERT_TRUE(contains(md, "]=0.00")) << "lost motion is positive there";
  const auto right = control(siemens_plugin(), {{"", eec}, {"", md}});
  std::string bad = md;
  bad.replace(bad.find("]=0.00"), 3, "]=-0");
  const auto wrong = control(siemens_plugin(), {{"", eec}, {"", bad}});
  ASSERT_TRUE(right && wrong);
  EXPECT_LT(math::after(curve, *right).B(), 0.2 * math::before(curve).B());
  EXPECT_GT(math::after(curve, *wrong).B(), 1.8 * math::before(curve).B());
}

}  // namespace every_table_test
