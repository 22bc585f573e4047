// SPDX-License-Identifier: Apache-2.0
//
// Three ways in which a table made a machine worse in silence: a constant of the instrument, an
// entry larger than its maker allows, a file that was cut.
#include <algorithm>
#include <cmath>

#include "nonio/controllers/size.h"
#include "workshop.h"

namespace zero_and_size_test {

using namespace workshop;

namespace {

struct Kind {
  const char* name;
  const char* plugin;
  Options options;
  std::string axes = "X number=1";
  bool below = false;
};

std::vector<Kind> kinds() {
  const Options error{{"sign", std::string("error")}};
  return {{"siemens-840d", "siemens-840d", {}},
          {"heidenhain-tnc", "heidenhain-tnc", {}},
          {"heidenhain-tnc", "heidenhain-tnc", {{"layout", std::string("itnc530")}}},
          {"fanuc", "fanuc", {{"extended", true}}},
          {"linuxcnc", "linuxcnc", {}},
          {"linuxcnc", "linuxcnc", {{"type", std::int64_t{1}}}},
          {"twincat-cnc", "twincat-cnc", {}},
          {"twincat-nc-ptp", "twincat-nc-ptp", {}},
          {"twincat-volumetric", "twincat-volumetric", error},
          {"fagor-8055", "fagor-8055", error},
          {"haas-classic", "haas-classic", error, "X number=1", true},
          {"mitsubishi", "mitsubishi", {}},
          {"pmac", "pmac", {}, "X number=1 counts_per_mm=2000"},
          {"aerotech", "aerotech", {}},
          {"ecmc", "ecmc", {}}};
}

/// 8 um up and down over 0 to 400 mm (or below 0), 4 um lost, an instrument that was not zeroed.
Bench sensor_at(double zero, bool below = false) {
  Measured m;
  m.targets = even(below ? -16 * 12.7 * mm : 0.0, below ? 12.7 * mm : 25 * mm, 17);
  m.plus = [zero](double x) { return zero + 8 * um * std::sin(x / (60 * mm)); };
  m.minus = [p = m.plus](double x) { return p(x) + 4 * um; };
  return Bench(m);
}

Options with(const Kind& k, const std::string& more) {
  Options o = k.options;
  o["axes"] = std::vector<std::string>{k.axes + more};
  return o;
}

double largest_entry(const Kind& k, const OutputResult& r, const Options& options) {
  const auto read = read_back(plugin(k.plugin), r.artifacts, options, {{.name = "X"}});
  EXPECT_TRUE(read && !read->empty())
      << k.name << ": " << (read ? "no table" : read.error().message);
  double largest = 0.0;
  if (read && !read->empty())
    for (const auto& v : {read->front().plus, read->front().minus})
      for (const double c : v) largest = std::max(largest, std::fabs(c));
  return largest;
}

std::string all_text(const OutputResult& r) {
  std::string out;
  for (const Artifact& a : r.artifacts) out += a.bytes;
  return out;
}

const Remark* note(const OutputResult& r, const std::string& id) {
  for (const Remark& n : r.notes)
    if (n.id == id) return &n;
  return nullptr;
}

}  // namespace

// A sensor whose zero is at 50.14 mm: a table must not move the motor there.
TEST(ZeroRule, TheInstrumentsZeroGoesIntoNoTable) {
  for (const Kind& k : kinds()) {
    const Options o = with(k, "");
    const auto r = sensor_at(50.14 * mm, k.below).write(plugin(k.plugin), o);
    ASSERT_TRUE(r) << k.name << ": " << r.error().message;
    EXPECT_LT(largest_entry(k, *r, o), 20 * um) << k.name;
    EXPECT_LT(largest_entry(k, *r, o), prediction(*r, "E").before + 5 * um) << k.name;
    const bool said =
        note(*r, "table.zero-taken") != nullptr || note(*r, "table.reference-at-zero") != nullptr;
    EXPECT_TRUE(said) << k.name;
    ASSERT_NE(note(*r, "table.size"), nullptr) << k.name;
    EXPECT_NEAR(note(*r, "table.size")->evidence.at(0).value, largest_entry(k, *r, o), 1e-9)
        << k.name;
    EXPECT_TRUE(contains(all_text(*r), "zero at")) << k.name;
    EXPECT_TRUE(contains(all_text(*r), "largest entry ")) << k.name;
  }
}

// Where the user says.
TEST(ZeroRule, ZeroWhereItIsSaid) {
  for (const Kind& k : kinds()) {
    const std::string name = k.name;
    const bool own = name == "haas-classic" || name == "pmac" || name == "aerotech";
    const Options o = with(k, " reference_mm=100");
    const auto r = sensor_at(7 * mm, k.below).write(plugin(k.plugin), o);
    ASSERT_EQ(bool(r), !own) << name;  // these count from their own zero
    if (own) {
      EXPECT_TRUE(contains(r.error().message, "reference_mm must be 0")) << r.error().message;
      continue;
    }
    const auto read = read_back(plugin(k.plugin), r->artifacts, o, {{.name = "X"}});
    ASSERT_TRUE(read) << name << read.error().message;
    const double x = 100 * mm;
    const double c = (math::added(read->front(), std::span(&x, 1), 1) +
                      math::added(read->front(), std::span(&x, 1), -1)) /
                     2;
    EXPECT_NEAR(c, 0.0, 0.5 * um + 1e-10) << name;
    ASSERT_NE(note(*r, "table.zero-at"), nullptr) << name;
    EXPECT_NEAR(note(*r, "table.zero-at")->evidence.at(0).value, x, 1e-12) << name;
  }
}

TEST(SizeRule, TheMakersLimitsAreKept) {
  for (const Kind& k : kinds()) {
    const Controller output = plugin(k.plugin);
    const auto bench = sensor_at(0.0, k.below);
    ASSERT_FALSE(
        bench.write(output, with(k, " largest_um=30 slope_um_per_m=300"))->artifacts.empty())
        << k.name;
    const auto large = bench.write(output, with(k, " largest_um=5"));
    ASSERT_TRUE(large) << k.name << large.error().message;
    EXPECT_TRUE(large->artifacts.empty()) << k.name;
    EXPECT_TRUE(large->predictions.empty()) << k.name;
    const Finding* f = finding(*large, "table.refused-size");
    ASSERT_NE(f, nullptr) << k.name;
    EXPECT_TRUE(f->attention);
    EXPECT_GT(f->evidence.at(0).value, 5 * um) << k.name;
    EXPECT_NEAR(f->evidence.at(1).value, 5 * um, 1e-12) << k.name;
    EXPECT_EQ(f->texts.at(1).second, "largest_um") << k.name;
    const auto steep = bench.write(output, with(k, " slope_um_per_m=50"));
    ASSERT_TRUE(steep) << k.name;
    EXPECT_TRUE(steep->artifacts.empty()) << k.name;
    const Finding* s = finding(*steep, "table.refused-slope");
    ASSERT_NE(s, nullptr) << k.name;
    EXPECT_NEAR(s->evidence.at(1).value, 50e-6, 1e-12) << k.name;
    EXPECT_EQ(s->texts.at(1).second, "slope_um_per_m") << k.name;
  }
}

// Also without a stated limit: no entry is larger than the readings explain.
TEST(SizeRule, WhatTheReadingsDoNotExplainIsRefused) {
  controllers::AxisJob job;
  job.axis = job.measurement = "X";
  job.curve.position = {0.0, 100 * mm, 200 * mm};
  job.curve.mean = job.curve.plus = job.curve.minus = {0.0, 6 * um, 8 * um};
  controllers::TableSize size;
  size.take(job.curve.position, job.curve.mean);
  OutputResult good, large, steep;
  EXPECT_FALSE(controllers::oversized(job, size, 0.1 * um, good));
  EXPECT_TRUE(good.findings.empty());
  size.largest = 50.14 * mm;
  EXPECT_TRUE(controllers::oversized(job, size, 0.1 * um, large));
  const Finding* f = finding(large, "table.refused-size");
  ASSERT_NE(f, nullptr);
  EXPECT_NEAR(f->evidence.at(0).value, 50.14 * mm, 1e-12);
  EXPECT_NEAR(f->evidence.at(1).value, 16.2 * um, 1e-12);  // 2 E, two steps
  EXPECT_EQ(f->texts.at(1).second, "E");
  size.largest = 8 * um;
  size.slope = 200e-6;  // 60 um/m were measured
  EXPECT_TRUE(controllers::oversized(job, size, 0.1 * um, steep));
  EXPECT_NE(finding(steep, "table.refused-slope"), nullptr);
}

// What a machine's record says of an axis is taken by every control.
TEST(Settings, TheKeysOfAMachineAreTakenEverywhere) {
  for (const Kind& k : kinds()) {
    const auto r =
        sensor_at(0.0, k.below)
            .write(plugin(k.plugin), with(k,
                                          " reference_mm=0 from_mm=-500 to_mm=600 largest_um=100 "
                                          "slope_um_per_m=1000 resolution_um=0.1 backlash_mm=0"));
    EXPECT_TRUE(r) << k.name << ": " << r.error().message;
  }
}

// 33 um of pitch and a reversal that swings by 0.2 um, far over its scatter.
TEST(Reversal, ASmallUnevenReversalDoesNotRefuseALargePitch) {
  Measured m;
  m.targets = even(0.0, 50 * mm, 11);
  m.plus = [](double x) { return 66 * um * x + 0.1 * um * std::sin(40 * x); };
  m.minus = [](double x) { return 66 * um * x - 0.1 * um * std::sin(40 * x); };
  m.runs = 5;
  m.scatter = 0.005 * um;
  for (const Kind& k : kinds()) {
    const std::string name = k.name;
    if (name == "linuxcnc" || name == "haas-classic") continue;  // directions; coarse steps
    const auto r = Bench(m).write(plugin(k.plugin), with(k, ""));
    ASSERT_TRUE(r) << name << ": " << r.error().message;
    EXPECT_EQ(finding(*r, "table.refused-reversal"), nullptr) << name;
    ASSERT_FALSE(r->artifacts.empty()) << name;
    EXPECT_LT(prediction(*r, "E").after, 1.5 * um) << name;
    EXPECT_GT(prediction(*r, "E").before, 30 * um) << name;
    // The backlash value is decided by itself: it stays.
    EXPECT_NEAR(prediction(*r, "B").after, prediction(*r, "B").before, 0.05 * um) << name;
    if (plugin(k.plugin).table.backlash.empty()) continue;
    EXPECT_NE(finding(*r, "table.backlash-not-constant"), nullptr) << name;
  }
}

// And the other way round: a pitch below half a step of 1 um, and a reversal of 5 um.
TEST(Reversal, ABacklashValueIsWrittenWithoutAPitchThatHelps) {
  Measured m;
  m.targets = even(0.0, 50 * mm, 9);
  m.plus = [](double x) { return std::fmod(x / (50 * mm) + 0.5, 2.0) < 1.0 ? 0.0 : 0.4 * um; };
  m.minus = [p = m.plus](double x) { return p(x) + 5 * um; };
  const auto r = Bench(m).write(fanuc_plugin());
  ASSERT_TRUE(r) << r.error().message;
  const std::string prm = file(*r, "fanuc-X.prm");
  EXPECT_TRUE(contains(prm, "N1851A1P5\n")) << prm;
  for (const std::string& line : lines(prm)) {
    const bool pitch = line.rfind("N1", 0) == 0 && line.size() > 6 && line[2] == '0';
    EXPECT_TRUE(!pitch || line.substr(6) == "P0") << line;
  }
  EXPECT_LT(prediction(*r, "E").after, 0.53 * um);
  EXPECT_NEAR(prediction(*r, "M").after, prediction(*r, "M").before, 1e-9);
  EXPECT_EQ(finding(*r, "table.no-gain"), nullptr);
}

TEST(Cut, AShorterFileIsNoTable) {
  const auto bench = sensor_at(0.0);
  for (const Kind& k : kinds()) {
    const std::string name = k.name;
    const char* ending = name == "linuxcnc" ? ".comp" : name == "twincat-nc-ptp" ? ".st" : nullptr;
    if (ending == nullptr) continue;
    const Controller output = plugin(k.plugin);
    const auto r = bench.write(output, with(k, ""));
    ASSERT_TRUE(r);
    for (const Artifact& a : r->artifacts) {
      if (!a.name.ends_with(ending)) continue;
      ASSERT_TRUE(read_back(output, {a}, k.options)) << name;
      int cut = 0;
      for (std::size_t n = 40; n < a.bytes.size(); ++n) {
        const bool line_end = a.bytes[n - 1] == '\n';
        std::vector<Artifact> files{{a.name, a.bytes.substr(0, n)}};
        if (line_end && name == "linuxcnc")  // only the text file next to it shows the cut
          for (const Artifact& other : r->artifacts)
            if (other.name != a.name) files.push_back(other);
        // An END_VAR without its line end is whole.
        if (a.bytes.substr(n) == "\n" && name != "linuxcnc") continue;
        EXPECT_FALSE(read_back(output, files, k.options)) << name << " cut behind " << n;
        ++cut;
      }
      EXPECT_GT(cut, 300);
    }
  }
}

TEST(Cut, ALineThatIsNoneIsNotTheEnd) {
  const auto read = [](const std::string& text) {
    return read_back(linuxcnc_plugin(), {{"linuxcnc-X.comp", text}});
  };
  EXPECT_TRUE(read("0 0 0\n50 50 50\n"));
  EXPECT_TRUE(read("0 0 0\n50 50 50\n\n"));  // an empty line at the end hides nothing
  const auto comment = read("0 0 0\n# the rest\n50 50 50\n");
  ASSERT_FALSE(comment);
  EXPECT_TRUE(contains(comment.error().message, "linuxcnc-X.comp, line 2: expected three numbers"))
      << comment.error().message;
  EXPECT_FALSE(read("0 0 0\n50 50 5"));
}

// A dial of 10 um: digits over a short travel are a step no slide makes.
TEST(Resolution, DigitsBetweenCloseTargetsAreNoTable) {
  struct Case {
    double apart, digits;
    bool refused;
    bool one_side = false;
  };
  for (const Case& c : {Case{10 * um, 1, true}, Case{10 * um, 3, true}, Case{1 * mm, 1, true},
                        Case{1 * mm, 2, true}, Case{25 * mm, 1, false}, Case{5 * mm, 2, true},
                        Case{5 * mm, 1, true, true}, Case{5 * mm, 2, true, true}})
    for (const Kind& k : kinds()) {
      const double sign = k.below ? -1 : 1, extra = sign * (200 * mm - c.apart);
      Measured m;
      m.targets = even(k.below ? -400 * mm : 0.0, 25 * mm, 17);
      if (c.apart < 25 * mm) m.targets.push_back(extra);
      std::sort(m.targets.begin(), m.targets.end());
      m.plus = [&](double x) {
        return 10 * um * (std::fabs(x) < 200 * mm - 1 * um ? 8 - c.digits : 8);
      };
      m.minus = m.plus;
      if (c.one_side) m.minus = [](double) { return 60 * um; };
      const auto r = Bench(m).write(plugin(k.plugin), with(k, ""));
      const std::string where = std::string(k.name) + ", " + std::to_string(c.apart) + " m, " +
                                std::to_string(c.digits) + " digits";
      ASSERT_TRUE(r) << where << ": " << r.error().message;
      const auto refused =
          std::find_if(r->findings.begin(), r->findings.end(),
                       [](const Finding& f) { return f.id == "table.refused-resolution"; });
      EXPECT_EQ(refused != r->findings.end(), c.refused) << where;
      EXPECT_EQ(r->artifacts.empty(), c.refused) << where;
      if (refused == r->findings.end()) continue;
      EXPECT_NEAR(refused->evidence.at(0).value, c.digits * 10 * um, 1e-9) << where;
      EXPECT_EQ(refused->evidence.at(3).name, "slope");
      EXPECT_NEAR(refused->evidence[3].value, c.digits * 10 * um / c.apart, 1e-6) << where;
      EXPECT_EQ(refused->evidence.at(4).name, "limit");
      EXPECT_GT(refused->evidence[3].value, refused->evidence[4].value) << where;
    }
}

// P-AXIS-00103 is a whole number of 0.1 um.
TEST(TwincatCnc, BacklashIsInTenthsOfAMicrometre) {
  const auto r = sensor_at(0.0).write(plugin("twincat-cnc"));
  ASSERT_TRUE(r);
  const std::string lis = file(*r, "twincat-cnc-X.lis");
  EXPECT_TRUE(contains(lis, "getriebe[0].lose = 40 (a whole number of 0.1 um: 0.004 mm)")) << lis;
  const auto read = read_back(plugin("twincat-cnc"), r->artifacts);
  ASSERT_TRUE(read);
  EXPECT_NEAR(read->front().backlash.value_or(0.0), 4 * um, 1e-12);
}

// -180 to 180 deg: both halves are corrected, also where they meet.
TEST(Aerotech, BothSidesOfHome) {
  Measured m;
  m.axis = m.id = "C";
  m.rotary = true;
  m.targets = even(-180 * deg, 15 * deg, 25);
  m.plus = [](double x) { return 8.2 * arcsec * std::sin(x + 0.4); };
  m.minus = m.plus;
  const auto r = Bench(m).write(plugin("aerotech"));
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_GT(prediction(*r, "E").before, 16 * arcsec);
  EXPECT_LT(prediction(*r, "E").after, 0.02 * arcsec);
  Measured linear;
  linear.targets = even(-200 * mm, 25 * mm, 17);
  linear.plus = linear.minus = [](double x) { return 8 * um * std::sin(x / (60 * mm)); };
  const auto both = Bench(linear).write(plugin("aerotech"));
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_LT(prediction(*both, "E").after, 0.05 * um);
  EXPECT_TRUE(contains(file(*both, "aerotech-X.cal"), "SAMPLEDIST=-25.0"));
}

}  // namespace zero_and_size_test
