// SPDX-License-Identifier: Apache-2.0
// The plugin as it was built, on campaigns of the exact machine.
#include "nonio/sdk/plugin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "bench.h"
#include "loaded_analysis.h"

namespace nonio {
namespace {

using namespace bench;

constexpr unsigned seed = 20261121;

const Analysis& the_analysis() {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "diagonal-straightness");
  return analysis;
}

Measurement named(const std::string& id, const std::string& kind, const std::string& axis) {
  Measurement m;
  m.id = id;
  m.kind = kind;
  m.axis = axis;
  return m;
}

/// Files of a campaign, read on the exact machine in two runs and both directions.
struct Workpiece {
  Rectangle rect;
  Errors errors;
  Campaign campaign;
  std::vector<Observations> all;
  double scatter = 0.0;
  machine::Curve BX = machine::zero, BY = machine::zero;  ///< reversal of positioning
  std::vector<int> directions{1, -1};                     ///< of approach, along the line
  std::mt19937 rng{seed};
  std::map<std::string, Setting> options;

  explicit Workpiece(const Rectangle& r, const Errors& e = {}) : rect(r), errors(e) {
    campaign.machine.structure = "gantry";
    for (const char* name : {"X", "Y"}) campaign.machine.axes.push_back(Axis{.name = name});
  }

  Observations& observe(Measurement m, const std::vector<Observations::AxisColumn>& places,
                        const std::vector<double>& mean, std::array<double, 3> sense) {
    std::normal_distribution<double> normal(0.0, 1.0);
    Observations o;
    o.measurement = m.id;
    o.lines.push_back({m.id, sense});
    o.axes = places;
    for (auto& a : o.axes) a.position.clear(), a.approach.clear();
    for (std::uint32_t run = 1; run <= 2; ++run)
      for (const int direction : directions)
        for (std::size_t j = 0; j < mean.size(); ++j) {
          double reversal = 0.0;
          for (std::size_t k = 0; k < places.size(); ++k) {
            const double p = places[k].position[j];
            o.axes[k].position.push_back(p);
            const bool rising = places[k].position.back() > places[k].position.front();
            o.axes[k].approach.push_back(static_cast<std::int8_t>(rising ? direction : -direction));
            const bool x = places[k].axis == "X";
            reversal += sense[x ? 0 : 1] * (x ? BX : BY)(p)*o.axes[k].approach.back() / 2.0;
          }
          o.deviation.push_back(mean[j] + reversal + scatter * normal(rng));
          o.run.push_back(run);
        }
    campaign.measurements.push_back(std::move(m));
    all.push_back(std::move(o));
    return all.back();
  }

  void diagonal(const std::string& id, const GridLine& line) {
    Measurement m = named(id, "diagonal", {});
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}, {"Y", false, {}, {}}};
    for (const std::size_t i : line.ix) places[0].position.push_back(rect.x(i));
    for (const std::size_t i : line.iy) places[1].position.push_back(rect.y(i));
    m.from = {{"X", places[0].position.front()}, {"Y", places[1].position.front()}};
    m.to = {{"X", places[0].position.back()}, {"Y", places[1].position.back()}};
    observe(std::move(m), places, line.mean, {line.cx, line.cy, 0.0});
  }
  void D1(const std::string& id = "D1") {
    diagonal(id, line(errors, rect, count(rect.n), count(rect.n)));
  }
  void D2(const std::string& id = "D2") {
    diagonal(id, line(errors, rect, count(rect.n), down(rect.n)));
  }
  void X(const std::string& id, double y) {
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}};
    for (const std::size_t i : count(rect.n)) places[0].position.push_back(rect.x(i));
    Measurement m = named(id, "axis", "X");
    m.at["Y"] = y;
    observe(std::move(m), places, pitch_x(errors, rect, y).mean, {1.0, 0.0, 0.0});
  }
  void Y(const std::string& id = "Y") {
    std::vector<Observations::AxisColumn> places{{"Y", false, {}, {}}};
    for (const std::size_t i : count(rect.n)) places[0].position.push_back(rect.y(i));
    observe(named(id, "axis", "Y"), places, pitch_y(errors, rect).mean, {0.0, 1.0, 0.0});
  }
  /// As an autocollimator reads it, to `noise` of its own.
  void yaw(double noise = 0.0, double factor = 1.0) {
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}};
    std::vector<double> mean;
    for (const std::size_t i : count(rect.n)) {
      places[0].position.push_back(rect.x(i));
      mean.push_back(3e-6 + factor * errors.ECX(rect.x(i)));  // its zero is free
    }
    Measurement m = named("yaw", "angle", "X");
    m.lateral = "Z";
    const double lengths = std::exchange(scatter, noise);
    observe(std::move(m), places, mean, {}).angular = true;
    scatter = lengths;
  }
  /// EYX against a straightedge whose own error is this.
  void straight(const std::string& id, const machine::Curve& edge) {
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}};
    std::vector<double> mean;
    for (const std::size_t i : count(rect.n)) {
      const double x = rect.x(i);
      places[0].position.push_back(x);
      mean.push_back(4 * um - 3e-6 * x + errors.EYX(x) + edge(x));
    }
    Measurement m = named(id, "straightness", "X");
    m.lateral = "Y";
    observe(std::move(m), places, mean, {0.0, 1.0, 0.0});
  }
  void turned_over(const machine::Curve& edge) {
    straight("SX", edge);
    straight("SX turned", [edge](double x) { return -edge(x); });
    campaign.measurements.back().reversal_of = "SX";
  }
  /// Both axes on a square whose error is g, as set up first and turned over about X.
  void square(double g) {
    campaign.squares.push_back({.name = "Q", .error = {}, .U = {}});
    for (const double sign : {1.0, -1.0})
      for (const bool x : {true, false}) {
        std::vector<Observations::AxisColumn> places{{x ? "X" : "Y", false, {}, {}}};
        std::vector<double> mean;
        for (const std::size_t i : count(rect.n)) {
          const double p = x ? rect.x(i) : rect.y(i);
          places[0].position.push_back(p);
          const machine::Vector at = machine::point(errors, {x ? p : 0.0, x ? 0.0 : p, 0.0});
          mean.push_back(x ? at.y() : at.x() + sign * g * p);
        }
        Measurement m = named(std::string(x ? "QX" : "QY") + (sign < 0.0 ? " t" : ""),
                              "straightness", x ? "X" : "Y");
        m.state = "";
        m.lateral = x ? "Y" : "X";
        m.square = "Q";
        m.square_turned = sign < 0.0;
        observe(std::move(m), places, mean, {});
      }
  }
  /// States everything that the manifest has of the uncertainty, small.
  void states_all() {
    campaign.instrument.U_fixed = 1e-9, campaign.instrument.U_per_length = 1e-10;
    Environment& e = campaign.environment;
    e.misalignment = e.temperature_range = 1e-3, e.temperature_difference = 0.01;
    e.expansion_range = 1e-9, e.drift = 1e-10;
    for (Axis& axis : campaign.machine.axes) axis.expansion = 1e-6;
  }
  Workpiece& everything() {
    X("X1", 0.5);
    X("X2", 8.5);
    Y();
    D1();
    D2();
    return *this;
  }

  std::size_t index(const std::string& id) const {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (campaign.measurements[i].id == id) return i;
    throw std::out_of_range(id);
  }
  Evaluation evaluate(const std::string& id = "D1") const {
    Settings settings;
    for (const Option& o : the_analysis().info.options) settings.values[o.name] = o.default_value;
    for (const auto& [name, value] : options) {
      EXPECT_EQ(settings.values.count(name), 1U) << name;
      settings.values[name] = value;
    }
    const std::size_t i = index(id);
    EXPECT_TRUE(the_analysis().applies(campaign, campaign.measurements[i]));
    const auto e =
        the_analysis().analyse({campaign, campaign.measurements[i], all[i], settings, &all});
    EXPECT_TRUE(e) << (e ? "" : e.error().message);
    return e.value_or(Evaluation{});
  }
};

const Finding* finding(const Evaluation& e, const std::string& id) {
  for (const Finding& f : e.findings)
    if (f.id == "diagonals." + id) return &f;
  return nullptr;
}
std::string ids(const Evaluation& e) {
  std::string out;
  for (const Finding& f : e.findings) out += f.id + " ";
  return out;
}
double value(const Evaluation& e, const std::string& name) {
  for (const Value& v : e.values)
    if (v.name == name) return v.value;
  ADD_FAILURE() << "no value " << name;
  return 0.0;
}
const Series* series(const Evaluation& e, const std::string& name) {
  for (const Series& s : e.series)
    if (s.name == name) return &s;
  return nullptr;
}

/// Refused: no value but the checks, no curve, and the reason by its name.
void expect_refused(const Workpiece& w, const std::string& why, const std::string& id = "D1") {
  const Evaluation e = w.evaluate(id);
  ASSERT_NE(finding(e, why), nullptr) << why << ", found " << ids(e);
  EXPECT_TRUE(finding(e, why)->attention);
  EXPECT_TRUE(e.series.empty());
  for (const Value& v : e.values) EXPECT_TRUE(v.name == "S_n" || v.name == "S_odd") << v.name;
}

TEST(DiagonalPlugin, RecoversTheMachineAndSaysWhatItUsed) {
  std::cout << "seed " << seed << "\n";
  std::mt19937 rng(seed);
  const Rectangle rect{12.0, 9.0, 30};
  const Errors errors = random_gantry(rng, rect);
  Workpiece w(rect, errors);
  w.everything();
  w.diagonal("D3", half_diagonal(errors, rect));
  const Evaluation e = w.evaluate();
  EXPECT_EQ(e.uses, (std::vector<std::string>{"D2", "D3", "Y", "X1", "X2"}));
  EXPECT_NEAR(value(e, "C0Y"), errors.C0Y, 0.01e-6);
  EXPECT_NEAR(value(e, "slave_shift"), 8.0 * errors.C0Y, 0.05 * um);
  const Series *f = series(e, "EYX"), *g = series(e, "EXY");
  ASSERT_TRUE(f != nullptr && g != nullptr) << ids(e);
  for (std::size_t i = 0; i <= rect.n; ++i) {
    EXPECT_NEAR(f->value[i], errors.EYX(f->position[i]), 0.05 * um);
    EXPECT_NEAR(g->value[i], errors.EXY(g->position[i]), 0.05 * um);
  }
  EXPECT_EQ(series(e, "q_odd"), nullptr);
}

TEST(DiagonalPlugin, TheSlaveIsShiftedWhereverTheManifestHasIt) {
  std::mt19937 rng(seed);
  const Rectangle rect{12.0, 9.0, 30};
  const Errors errors = random_gantry(rng, rect);
  for (const bool first : {true, false}) {
    Workpiece w(rect, errors);
    w.everything();
    for (Measurement& m : w.campaign.measurements)
      if (m.id == "X1" || m.id == "X2") m.side = (m.id == "X1") == first ? "slave" : "master";
    const Evaluation e = w.evaluate();
    EXPECT_NEAR(value(e, "slave_shift"), (first ? -8.0 : 8.0) * errors.C0Y, 0.05 * um);
  }
}

TEST(DiagonalPlugin, NeverSplitsWhatTwoDiagonalsDoNotContain) {
  Workpiece w({12.0, 9.0, 30});
  w.errors.EXY = [](double y) { return 50 * um * std::sin(2.0 * std::numbers::pi * y / 9.0); };
  w.errors.EYX = [](double x) {
    return -50 * um * 12.0 / 9.0 * std::sin(2.0 * std::numbers::pi * x / 12.0);
  };
  w.everything();
  Evaluation e = w.evaluate();
  ASSERT_NE(finding(e, "not-separable"), nullptr) << ids(e);
  EXPECT_EQ(finding(e, "not-separable")->evidence.front().value, 14.0);
  EXPECT_EQ(series(e, "EYX"), nullptr);
  EXPECT_EQ(series(e, "EXY"), nullptr);
  ASSERT_NE(series(e, "EYX_even"), nullptr);
  for (const double v : series(e, "q_odd")->value) EXPECT_LT(std::fabs(v), 0.01 * um);
  w.options["EXY_odd_bound_um"] = 50.0;
  e = w.evaluate();
  ASSERT_NE(finding(e, "not-separable-band"), nullptr) << ids(e);
  const Series *low = series(e, "EYX_low"), *high = series(e, "EYX_high");
  for (std::size_t i = 0; i <= 30; ++i) {
    const double truth = w.errors.EYX(low->position[i]);
    EXPECT_LE(low->value[i], truth + 0.05 * um);
    EXPECT_GE(high->value[i], truth - 0.05 * um);
  }
}

TEST(DiagonalPlugin, ASingleColumnNeverBowsTheOtherWay) {
  Workpiece w({12.0, 9.0, 30});
  w.campaign.machine.structure = "single-column";
  w.errors.EYX = [](double x) { return 160 * um * x / 12.0 * (1.0 - x / 12.0); };
  w.errors.ECX = [](double x) { return -320 * um / 144.0 * x; };
  w.errors.C0Y = -160 * um / 12.0;
  w.errors.y_ref = 4.5;
  w.X("X", 4.5);
  w.Y();
  w.D1();
  w.D2();
  expect_refused(w, "refused-single-column");
  w.campaign.machine.structure = "gantry";
  expect_refused(w, "yaw-needed");

  w.campaign.machine.structure = "single-column";
  w.yaw();
  const Evaluation with_yaw = w.evaluate();
  ASSERT_NE(series(with_yaw, "EYX_even"), nullptr) << ids(with_yaw);
  EXPECT_NEAR(series(with_yaw, "EYX_even")->value[15], 40 * um, 0.05 * um);
  EXPECT_NEAR(series(with_yaw, "ECX")->value[30], w.errors.ECX(12.0), 1e-9);
  const auto place = std::find_if(with_yaw.notes.begin(), with_yaw.notes.end(),
                                  [](const auto& n) { return n.id == "method.squareness-place"; });
  ASSERT_NE(place, with_yaw.notes.end());
  EXPECT_NEAR(place->evidence.at(0).value, w.errors.ECX(6.0), 1e-9);
  w.campaign.measurements[0].at.clear();
  expect_refused(w, "refused-place");

  Workpiece measured({12.0, 9.0, 30}, w.errors);
  measured.campaign.machine.structure = "single-column";
  const Evaluation e = measured.everything().evaluate();
  ASSERT_NE(series(e, "EYX_even"), nullptr) << ids(e);
  EXPECT_NEAR(series(e, "EYX_even")->value[15], 40 * um, 0.05 * um);
}

TEST(DiagonalPlugin, BadInputIsRefusedByName) {
  const Rectangle rect{12.0, 9.0, 10};
  Workpiece w(rect);
  w.everything();
  const Workpiece good = w;
  EXPECT_NE(finding(good.evaluate(), "not-separable"), nullptr);

  w.D1("D1b");
  expect_refused(w, "refused-sets");
  w = Workpiece(rect);
  w.X("X1", 0.5), w.X("X2", 8.5), w.Y(), w.D1();
  expect_refused(w, "refused-missing-diagonal");
  w = good;  // unequal number of stops
  w.campaign.measurements.pop_back(), w.all.pop_back();
  w.rect.n = 12;
  w.D2();
  expect_refused(w, "refused-stops");
  w = good;  // unequal steps: mm typed instead of the next whole step
  for (double& x : w.all[3].axes[0].position)
    if (std::fabs(x - 6.0) < 1e-9) x = 6.3;
  expect_refused(w, "refused-stops");
  w = good;  // a stop that was not read
  for (auto& a : w.all[4].axes) {
    std::vector<double> kept;
    for (std::size_t i = 0; i < a.position.size(); ++i)
      if (i % 11 != 4) kept.push_back(a.position[i]);
    a.position = kept;
    a.approach.resize(kept.size());
  }
  w.all[4].deviation.resize(w.all[4].axes[0].position.size());
  expect_refused(w, "refused-stops");
  w = good;  // positioning of Y from one direction only, and D2 runs against it
  for (auto& a : w.all[2].axes) std::fill(a.approach.begin(), a.approach.end(), std::int8_t{1});
  expect_refused(w, "refused-one-direction");
  w = good;  // a stop of D1 that was read from + and another one from - only
  for (auto& a : w.all[3].axes)
    for (std::size_t i = 0; i < a.approach.size(); ++i)
      if (i % 11 == 3 || i % 11 == 5) a.approach[i] = i % 11 == 3 ? 1 : -1;
  expect_refused(w, "refused-one-direction");
  w = good;
  w.yaw(), w.yaw();
  expect_refused(w, "refused-ambiguous");
  w = good;
  w.Y("Y-again");
  expect_refused(w, "refused-ambiguous");
  w = good;
  w.campaign.measurements[0].at.clear();
  expect_refused(w, "refused-place");
  w = good;
  for (double& x : w.all[2].axes[0].position) x *= 1.001;
  expect_refused(w, "refused-pitch-points");
  w = Workpiece(rect);
  w.X("X1", 0.5), w.X("X2", 8.5), w.D1(), w.D2();
  expect_refused(w, "refused-pitch");
  w = good;
  w.campaign.measurements[0].at["Z"] = 0.4;
  for (const std::size_t i : {3UL, 4UL})
    w.campaign.measurements[i].from["Z"] = w.campaign.measurements[i].to["Z"] = 0.1;
  expect_refused(w, "refused-height");
}

TEST(DiagonalPlugin, OneDirectionGoesWithPositioningInItsDirections) {
  std::mt19937 rng(seed + 5);
  std::cout << "seed " << seed + 5 << "\n";
  const Rectangle rect{12.0, 9.0, 30};
  for (const bool autocollimator : {false, true}) {
    Workpiece w(rect, random_gantry(rng, rect));
    w.BX = [](double x) { return -4 * um - 9 * um * x / 12.0; };
    w.BY = [](double y) { return 5 * um - 7 * um * y / 9.0; };
    w.X("X1", 0.5);
    autocollimator ? w.yaw() : w.X("X2", 8.5);
    w.Y();
    w.directions = {1};
    w.D1();
    w.D2();
    w.diagonal("D3", half_diagonal(w.errors, rect));
    const Evaluation e = w.evaluate();
    ASSERT_NE(series(e, "EYX"), nullptr) << ids(e);
    EXPECT_NE(finding(e, "one-direction"), nullptr);
    EXPECT_EQ(finding(e, "reversal"), nullptr);
    EXPECT_NEAR(value(e, "C0Y"), w.errors.C0Y, 0.01e-6);
    for (std::size_t i = 0; i <= rect.n; ++i) {
      EXPECT_NEAR(series(e, "EYX")->value[i], w.errors.EYX(rect.x(i)), 0.05 * um);
      EXPECT_NEAR(series(e, "EXY")->value[i], w.errors.EXY(rect.y(i)), 0.05 * um);
    }
  }
}

/// What the finding says of lateral reversal: Y comes back on another line, which changes along Y.
TEST(DiagonalPlugin, LateralReversalIsWorthWhatIsSaid) {
  const Rectangle rect{12.0, 9.0, 30};
  Workpiece w(rect);
  w.X("X1", 0.5), w.X("X2", 8.5), w.Y();
  w.directions = {1};
  const auto b = [](double y) { return 2 * um * std::sin(std::numbers::pi * y / 9.0); };
  w.errors.EXY = [b](double y) { return b(y) / 2.0; };  // Y moves towards plus on D1,
  w.D1();
  w.errors.EXY = [b](double y) { return -b(y) / 2.0; };  // and towards minus on D2
  w.D2();
  const Evaluation e = w.evaluate();
  ASSERT_NE(finding(e, "one-direction"), nullptr) << ids(e);
  const double per_um = finding(e, "one-direction")->evidence[0].value;
  EXPECT_NEAR(series(e, "EYX_even")->value[15], b(4.5) * per_um / um, 0.02 * um);
  EXPECT_EQ(finding(e, "one-direction")->texts[1].second, "EYX");
}

TEST(DiagonalPlugin, AYawThatContradictsTwoLinesIsSaid) {
  std::mt19937 rng(seed + 6);
  std::cout << "seed " << seed + 6 << "\n";
  const Rectangle rect{12.0, 9.0, 20};
  for (const bool turned : {false, true}) {
    Workpiece w(rect, random_gantry(rng, rect));
    w.scatter = 0.3 * um;
    w.everything();
    w.yaw(0.05e-6, turned ? -1.0 : 1.0);
    const Evaluation e = w.evaluate();
    EXPECT_EQ(finding(e, "yaw-disagrees") != nullptr, turned) << ids(e);
    EXPECT_NE(series(e, "EYX_even"), nullptr);
  }
}

TEST(DiagonalPlugin, ADiagonalNamedFromTheOtherEndIsTheSame) {
  std::mt19937 rng(seed + 1);
  std::cout << "seed " << seed + 1 << "\n";
  const Rectangle rect{12.0, 9.0, 30};
  const Errors errors = random_gantry(rng, rect);
  Workpiece w(rect, errors), turned(rect, errors);
  w.everything();
  turned.X("X1", 0.5), turned.X("X2", 8.5), turned.Y(), turned.D1();
  turned.diagonal("D2", line(errors, rect, down(rect.n), count(rect.n)));
  const auto a = w.evaluate(), b = turned.evaluate();
  ASSERT_NE(series(b, "q_odd"), nullptr) << ids(b);
  EXPECT_NEAR(value(a, "C0Y"), value(b, "C0Y"), 1e-9);
  for (std::size_t i = 0; i <= rect.n; ++i)
    EXPECT_NEAR(series(a, "q_odd")->value[i], series(b, "q_odd")->value[i], 0.01 * um);
}

/// The same readings of the machine's mirror image, in which Y carries X. What is read about Z has the other sign.
Workpiece mirror_image(Workpiece w) {
  const auto other = [](std::string& axis) { axis = axis == "X" ? "Y" : axis == "Y" ? "X" : axis; };
  const auto others = [&](std::map<std::string, double>& places) {
    std::map<std::string, double> out;
    for (const auto& [axis, place] : places) {
      std::string name = axis;
      other(name);
      out[name] = place;
    }
    places = std::move(out);
  };
  for (std::size_t i = 0; i < w.all.size(); ++i) {
    Measurement& m = w.campaign.measurements[i];
    Observations& o = w.all[i];
    other(m.axis), other(m.lateral), others(m.at), others(m.from), others(m.to);
    for (auto& axis : o.axes) other(axis.axis);
    if (o.axes.size() == 2) std::swap(o.axes[0], o.axes[1]);
    for (auto& of : o.lines) std::swap(of.sense[0], of.sense[1]);
    if (o.angular)
      for (double& v : o.deviation) v = -v;
  }
  return w;
}

void expect_mirrored(const Evaluation& a, const Evaluation& b) {
  for (const char* name : {"C0Y", "C0Y_LSQ", "slave_shift", "racking", "S_n", "S_odd"})
    for (const Value& v : a.values) {
      if (v.name != name) continue;
      EXPECT_NEAR(value(b, name), v.value, 1e-6 * um + 1e-9 * std::fabs(v.value)) << name;
      for (const Value& of : b.values)
        if (of.name == name && v.U) {
          EXPECT_NEAR(of.U.value_or(0.0), *v.U, 1e-6 * *v.U) << name;
        }
    }
  const std::vector<std::array<const char*, 3>> pairs{
      {"EYX", "EXY", ""},           {"EXY", "EYX", ""},     {"EYX_even", "EXY_even", ""},
      {"EXY_even", "EYX_even", ""}, {"q_odd", "q_odd", ""}, {"ECX", "ECY", "-"}};
  for (const auto& [one, two, sign] : pairs) {
    const Series *f = series(a, one), *g = series(b, two);
    ASSERT_EQ(f == nullptr, g == nullptr) << one << ids(b);
    if (f == nullptr) continue;
    EXPECT_EQ(g->over, std::string(one) == "q_odd" ? "X" : f->over == "X" ? "Y" : "X");
    for (std::size_t i = 0; i < f->value.size(); ++i)
      EXPECT_NEAR(g->value[i], *sign == '-' ? -f->value[i] : f->value[i], 1e-6 * um) << one << i;
  }
  const auto *D1 = a.points.column("D1"), *E1 = b.points.column("D1"), *D2 = a.points.column("D2"),
             *E2 = b.points.column("D2");
  ASSERT_TRUE(D1 && E1 && D2 && E2);
  for (std::size_t i = 0; i < D1->values.size(); ++i) {
    EXPECT_NEAR(E1->values[i], D1->values[i], 1e-6 * um);
    // The second diagonal begins at small X: in the image this is its other end.
    EXPECT_NEAR(E2->values[i], D2->values.back() - D2->values[D2->values.size() - 1 - i],
                1e-6 * um);
  }
}

TEST(DiagonalPlugin, AYThatCarriesXIsTheMirrorImage) {
  std::mt19937 rng(seed + 9);
  std::cout << "seed " << seed + 9 << "\n";
  const Rectangle rect{12.0, 9.0, 30};
  for (int c = 0; c < 8; ++c) {
    Workpiece w(rect, random_gantry(rng, rect));
    w.scatter = 0.3 * um;
    w.states_all();
    w.everything();
    if (c == 5) w.yaw(0.05e-6);
    if (c % 2 == 1) w.diagonal("D3", half_diagonal(w.errors, rect));
    const bool sides = c % 4 < 2;
    Workpiece image = mirror_image(w);
    image.campaign.machine.axes[1].slave = sides ? "Y2" : "";
    w.campaign.machine.axes[0].slave = sides ? "X2" : "";
    for (Workpiece* of : {&w, &image})
      for (Measurement& m : of->campaign.measurements)
        if (sides && m.id[0] == 'X') m.side = m.id == "X1" ? "master" : "slave";
    image.campaign.machine.structure = sides ? "" : c % 4 == 2 ? "gantry" : "bridge";
    const Evaluation a = w.evaluate(), b = image.evaluate();
    ASSERT_NE(series(a, c % 2 == 1 ? "EYX" : "EYX_even"), nullptr) << ids(a);
    expect_mirrored(a, b);
  }
}

TEST(DiagonalPlugin, AYOnTwoLinesWithoutAStatementThatItCarriesXIsRefused) {
  Workpiece w({12.0, 9.0, 10});
  w.everything();
  Workpiece image = mirror_image(w);
  image.campaign.machine.structure = "";
  expect_refused(image, "refused-carrier");
  image.campaign.machine.axes[1].slave = "Y2";
  EXPECT_NE(finding(image.evaluate(), "not-separable"), nullptr);
  for (Measurement& m : image.campaign.measurements) m.at.clear();
  expect_refused(image, "refused-place");
}

TEST(DiagonalPlugin, OneDirectionOnAYThatCarriesXNamesTheRightCurve) {
  Workpiece w({12.0, 9.0, 30});
  w.X("X1", 0.5), w.X("X2", 8.5), w.Y();
  w.directions = {1};
  w.D1(), w.D2();
  const Evaluation e = mirror_image(w).evaluate();
  ASSERT_NE(finding(e, "one-direction"), nullptr) << ids(e);
  EXPECT_EQ(finding(e, "one-direction")->texts[0].second, "X");
  EXPECT_EQ(finding(e, "one-direction")->texts[1].second, "EXY");
}

TEST(DiagonalPlugin, ClosureRefusesAChangedPitch) {
  Workpiece w({12.0, 9.0, 30});
  w.scatter = 0.5 * um;
  w.everything();
  for (std::size_t i = 0; i < w.all[2].size(); ++i)  // Y grew by 2 um/m after it was measured
    w.all[2].deviation[i] -= 2e-6 * w.all[2].axes[0].position[i];
  expect_refused(w, "closure");
}

TEST(DiagonalPlugin, ReversalOfTheAxesHasToBeThatOfTheDiagonals) {
  Workpiece w({12.0, 9.0, 30});
  w.scatter = 0.5 * um;
  w.everything();
  const auto reverse = [&](std::size_t i, double B) {
    for (std::size_t k = 0; k < w.all[i].size(); ++k)
      w.all[i].deviation[k] += w.all[i].axes[0].approach[k] * B / 2.0;
  };
  reverse(0, -4 * um), reverse(1, -4 * um), reverse(2, -2 * um);
  EXPECT_NE(finding(w.evaluate(), "reversal"), nullptr);
  reverse(3, -4.4 * um), reverse(4, -4.4 * um);  // 0.8 * -4 + 0.6 * -2
  EXPECT_EQ(finding(w.evaluate(), "reversal"), nullptr) << ids(w.evaluate());
}

TEST(DiagonalPlugin, FlatDiagonalsGiveSquarenessOnly) {
  Workpiece w({12.0, 1.8, 30});
  w.errors.C0Y = 5e-6;
  w.X("X1", 0.1), w.X("X2", 1.7), w.Y(), w.D1(), w.D2();
  const auto e = w.evaluate();
  ASSERT_NE(finding(e, "flat"), nullptr) << ids(e);
  EXPECT_TRUE(e.series.empty());
  EXPECT_NEAR(value(e, "C0Y"), 5e-6, 0.01e-6);
}

TEST(DiagonalPlugin, SetsBeforeAndAfterAreApart) {
  Workpiece w({12.0, 9.0, 30});
  w.errors.C0Y = 8e-6;
  w.X("X1", 0.5), w.X("X2", 8.5), w.Y(), w.D1("D1 00"), w.D2("D2 00");
  w.errors.C0Y = 0.5e-6;
  w.D1("D1 final"), w.D2("D2 final");
  const auto before = w.evaluate("D1 00"), after = w.evaluate("D1 final");
  EXPECT_NEAR(value(before, "C0Y"), 8e-6, 0.01e-6);
  EXPECT_NEAR(value(after, "C0Y"), 0.5e-6, 0.01e-6);
  EXPECT_EQ(finding(before, "remeasured"), nullptr);
  EXPECT_NE(finding(after, "remeasured"), nullptr);
  EXPECT_FALSE(the_analysis().applies(w.campaign, w.campaign.measurements[w.index("D2 00")]));
}

TEST(DiagonalPlugin, SetsAreThoseOfTheKeyState) {
  Workpiece w({12.0, 9.0, 30});
  w.errors.C0Y = 8e-6;
  w.X("X 1", 0.5), w.X("X 2", 8.5), w.Y(), w.D1("D1"), w.D2("D2");
  w.errors.C0Y = 0.5e-6;
  w.D1("D3"), w.D2("D4");
  for (Measurement& m : w.campaign.measurements)
    m.state = m.kind != "diagonal" ? "" : m.id < "D3" ? "before" : "final";
  EXPECT_NEAR(value(w.evaluate("D1"), "C0Y"), 8e-6, 0.01e-6);
  EXPECT_NEAR(value(w.evaluate("D3"), "C0Y"), 0.5e-6, 0.01e-6);
  EXPECT_FALSE(the_analysis().applies(w.campaign, w.campaign.measurements[w.index("D4")]));
}

/// Two lines of X; yaw by an autocollimator; diagonals from one direction; a third diagonal.
TEST(DiagonalPlugin, UncertaintiesFromTheScatterCoverTheTruth) {
  const Rectangle rect{12.0, 9.0, 6};
  constexpr int campaigns = 2000;
  const auto prepare = [](Workpiece& w, const std::string& how) {
    w.scatter = 1 * um;
    w.X("X1", 0.5);
    how == "autocollimator" ? w.yaw(0.2e-6) : w.X("X2", 8.5);
    w.Y();
    if (how == "one direction") w.directions = {1};
    w.D1();
    w.D2();
    if (how == "third diagonal") w.diagonal("D3", half_diagonal(w.errors, w.rect));
  };
  for (const std::string how : {"two lines", "autocollimator", "one direction", "third diagonal"}) {
    std::mt19937 rng(seed + 2);
    const Errors errors = random_gantry(rng, rect);
    double inside = 0.0, inside_k = 0.0, inside_racking = 0.0, solved = 0.0, low = 0.0, high = 0.0;
    for (std::size_t i = 0; i <= rect.n; ++i) {
      const double apart = -8.0 * errors.ECX(rect.x(i));
      low = std::min(low, apart), high = std::max(high, apart);
    }
    for (int c = 0; c < campaigns; ++c) {
      Workpiece w(rect, errors);
      w.rng.seed(seed + 100 + static_cast<unsigned>(c));
      prepare(w, how);
      const Evaluation e = w.evaluate();
      const bool both = how == "third diagonal";
      const Series* f = series(e, both ? "EYX" : "EYX_even");
      if (f == nullptr) continue;  // the closure has its own rate of false alarms
      solved += 1.0;
      for (std::size_t i = 1; i < rect.n; ++i) {
        const double here = errors.EYX(rect.x(i)), across = errors.EYX(rect.x(rect.n - i));
        const double truth = both ? here : (here + across) / 2.0;
        inside += (std::fabs(f->value[i] - truth) <= f->repeatability[i]) /
                  static_cast<double>(rect.n - 1);
      }
      for (const Value& v : e.values)
        if (v.name == "C0Y")
          inside_k += std::fabs(v.value - errors.C0Y) <= *v.repeatability;
        else if (v.name == "racking")
          inside_racking += std::fabs(v.value - (high - low)) <= *v.repeatability;
    }
    std::cout << "seed " << seed + 2 << ", " << how << ": EYX " << 100.0 * inside / solved
              << " %, C0Y " << 100.0 * inside_k / solved << " %, racking "
              << 100.0 * inside_racking / solved << " % of " << solved << "\n";
    EXPECT_GE(solved, 0.99 * campaigns) << how;
    if (how == "two lines") {
      EXPECT_GE(inside_racking, 0.93 * solved);
      EXPECT_LE(inside_racking, 0.97 * solved);
    }
    for (const double hit : {inside, inside_k}) {
      EXPECT_GE(hit, 0.93 * solved) << how;
      EXPECT_LE(hit, 0.97 * solved) << how;
    }
  }
}

/// A straightedge with 20 um of its own, even and odd about its middle.
machine::Curve crooked(double length) {
  return [length](double x) {
    const double t = x / length;
    return 20 * um * (4.0 * t * (1.0 - t) + std::sin(2.0 * std::numbers::pi * t));
  };
}

TEST(DiagonalPlugin, AStraightedgeTurnedOverLeavesNothingOfItself) {
  const Rectangle rect{12.0, 9.0, 12};
  std::mt19937 rng(seed + 6);
  const Errors errors = random_gantry(rng, rect);
  const auto with = [&](bool turned, double scatter) {
    Workpiece w(rect, errors);
    w.scatter = scatter;
    w.states_all();
    w.everything();
    turned ? w.turned_over(crooked(rect.Lx)) : w.straight("SX", crooked(rect.Lx));
    return w;
  };
  const Evaluation exact = with(true, 0.0).evaluate();
  const Series* f = series(exact, "EYX");
  ASSERT_NE(f, nullptr) << ids(exact);
  for (std::size_t i = 0; i <= rect.n; ++i)
    EXPECT_NEAR(f->value[i], errors.EYX(f->position[i]), 0.05 * um);
  EXPECT_EQ(exact.uses, (std::vector<std::string>{"D2", "Y", "X1", "X2", "SX", "SX turned"}));

  const Evaluation turned = with(true, 0.5 * um).evaluate(), one = with(false, 0.5 * um).evaluate();
  EXPECT_NE(finding(turned, "straightness-agrees"), nullptr) << ids(turned);
  EXPECT_NE(finding(one, "straightness-disagrees"), nullptr) << ids(one);
  const Series* wrong = series(one, "EYX");
  ASSERT_NE(wrong, nullptr);
  EXPECT_GT(std::fabs(wrong->value[3] - errors.EYX(wrong->position[3])), 15 * um)
      << "the straightedge's own odd part";

  Workpiece w = with(true, 0.5 * um);
  for (double& x : w.all.back().axes[0].position)
    if (x == rect.x(2)) x += 0.01;
  expect_refused(w, "refused-pitch-points");
}

/// U of the curves, and how often the comparison sees a difference that is not there.
TEST(DiagonalPlugin, UncertaintiesWithAStraightedgeTurnedOverCoverTheTruth) {
  const Rectangle rect{12.0, 9.0, 6};
  std::mt19937 rng(seed + 7);
  std::cout << "seed " << seed + 7 << "\n";
  const Errors errors = random_gantry(rng, rect);
  constexpr int campaigns = 2000;
  double f_inside = 0.0, g_inside = 0.0, solved = 0.0, false_alarms = 0.0, below_half = 0.0;
  for (int c = 0; c < campaigns; ++c) {
    Workpiece w(rect, errors);
    w.rng.seed(seed + 5000 + static_cast<unsigned>(c));
    w.scatter = 1 * um;
    w.states_all();
    w.everything();
    w.scatter = 3 * um;
    w.turned_over(crooked(rect.Lx));
    const Evaluation e = w.evaluate();
    const Series *f = series(e, "EYX"), *g = series(e, "EXY");
    if (f == nullptr || g == nullptr) continue;
    solved += 1.0;
    false_alarms += finding(e, "straightness-disagrees") != nullptr;
    for (const Finding& found : e.findings)
      if (found.id.rfind("diagonals.straightness-", 0) == 0)
        below_half += found.evidence.back().value < 0.5;
    const double inner = static_cast<double>(rect.n - 1);
    for (std::size_t i = 1; i < rect.n; ++i) {
      f_inside += (std::fabs(f->value[i] - errors.EYX(rect.x(i))) <= f->U[i]) / inner;
      g_inside += (std::fabs(g->value[i] - errors.EXY(rect.y(i))) <= g->U[i]) / inner;
    }
  }
  std::cout << "EYX " << 100.0 * f_inside / solved << " %, EXY " << 100.0 * g_inside / solved
            << " % of " << solved << ", false disagreements " << 100.0 * false_alarms / solved
            << " %, p below 0.5: " << 100.0 * below_half / solved << " %\n";
  EXPECT_GE(solved, 0.99 * campaigns);
  for (const double hit : {f_inside, g_inside}) {
    EXPECT_GE(hit, 0.94 * solved);
    EXPECT_LE(hit, 0.965 * solved);
  }
  EXPECT_LE(false_alarms, 0.02 * solved);
}

/// Sides that run together: the range of what only scatters is said to be an upper limit.
TEST(DiagonalPlugin, RackingIsNotTakenFromScatter) {
  std::mt19937 rng(seed + 9);
  const Rectangle rect{12.0, 9.0, 10};
  Errors errors = random_gantry(rng, rect);
  const auto racking_of = [&](double scatter) {
    Workpiece w(rect, errors);
    w.scatter = scatter;
    w.X("X1", 0.5), w.X("X2", 8.5), w.Y(), w.D1(), w.D2();
    return w.evaluate();
  };
  double low = 0.0, high = 0.0;
  for (std::size_t i = 0; i <= rect.n; ++i) {
    const double apart = -8.0 * errors.ECX(rect.x(i));
    low = std::min(low, apart), high = std::max(high, apart);
  }
  const Evaluation racks = racking_of(0.5 * um);
  EXPECT_NEAR(value(racks, "racking"), high - low, 2 * um);
  EXPECT_EQ(finding(racks, "racking-noise"), nullptr) << ids(racks);
  errors.ECX = machine::zero;
  EXPECT_NE(finding(racking_of(0.5 * um), "racking-noise"), nullptr);
}

/// Diagonals and a square: one value where they agree, with a U that covers; a finding where not.
TEST(DiagonalPlugin, SquarenessOfASquareIsOneValueOrAFinding) {
  const Rectangle rect{1.2, 0.9, 6};
  std::mt19937 rng(seed + 8);
  std::cout << "seed " << seed + 8 << "\n";
  Errors errors = random_gantry(rng, rect, 10 * um);
  errors.ECX = machine::zero;
  constexpr int campaigns = 2000;
  Workpiece exact(rect, errors);
  exact.states_all();
  exact.X("X1", 0.05), exact.X("X2", 0.85), exact.Y(), exact.D1(), exact.D2();
  const double truth = value(exact.evaluate(), "C0Y_LSQ");
  double inside = 0.0, solved = 0.0, disagree = 0.0, moved_found = 0.0, moved = 0.0;
  for (int c = 0; c < campaigns; ++c) {
    Workpiece w(rect, errors);
    w.rng.seed(seed + 20000 + static_cast<unsigned>(c));
    w.scatter = 1 * um;
    w.states_all();
    w.X("X1", 0.05), w.X("X2", 0.85), w.Y(), w.D1(), w.D2();
    const bool other_machine = c % 20 == 0;
    if (other_machine) w.errors.C0Y += 25e-6;
    w.square(40e-6);
    const Evaluation e = w.evaluate();
    const bool differs = finding(e, "squareness-disagrees") != nullptr;
    if (finding(e, "closure") != nullptr) continue;
    if (other_machine) {
      moved += 1.0, moved_found += differs;
      EXPECT_FALSE(differs && series(e, "C0Y_both") != nullptr);
      continue;
    }
    solved += 1.0, disagree += differs;
    if (differs) continue;
    for (const Value& v : e.values)
      if (v.name == "C0Y_both") inside += std::fabs(v.value - truth) <= *v.U;
  }
  std::cout << "C0Y_both " << 100.0 * inside / (solved - disagree) << " %, false disagreements "
            << 100.0 * disagree / solved << " % of " << solved << ", moved machines found "
            << moved_found << " of " << moved << "\n";
  EXPECT_GE(inside, 0.94 * (solved - disagree));
  EXPECT_LE(inside, 0.97 * (solved - disagree));
  EXPECT_LE(disagree, 0.02 * solved);
  EXPECT_GE(moved_found, 0.95 * moved);
}

}  // namespace
}  // namespace nonio
