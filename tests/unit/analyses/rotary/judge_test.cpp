// SPDX-License-Identifier: Apache-2.0
//
// What the plugin says of good and bad measurements.
#include <gtest/gtest.h>

#include <limits>

#include "nonio/sdk/plugin.h"
#include "table.h"
#include "words.h"

extern "C" const nonio::PluginEntry nonio_plugin;

namespace nonio {
namespace {

using namespace turntable;

Analysis the_analysis() {
  struct Taker final : Registry {
    Analysis analysis;
    void add(Method) override { ADD_FAILURE() << "a method"; }
    void add(Reader) override { ADD_FAILURE() << "a reader"; }
    void add(Effect) override { ADD_FAILURE() << "an effect"; }
    void add(Analysis a) override { analysis = std::move(a); }
    void add(Output) override { ADD_FAILURE() << "an output"; }
    void add(Controller) override { ADD_FAILURE() << "a controller"; }
  } taker;
  nonio_plugin.add_to(taker);
  return taker.analysis;
}

/// A campaign as the host gives it to the plugin.
struct Workshop {
  Campaign campaign;
  std::vector<Observations> all;
  Settings options;

  Workshop() {
    for (const Option& o : the_analysis().info.options) options.values[o.name] = o.default_value;
  }
  Workshop& measured(const std::string& id, const std::vector<math::BallCentre>& centres) {
    Measurement m;
    m.id = m.axis = id;
    m.kind = "ball-centres";
    campaign.measurements.push_back(m);
    all.push_back(observed(centres, id));
    return *this;
  }
  Workshop& with(const std::string& name, Setting value) {
    options.values[name] = std::move(value);
    return *this;
  }
  Evaluation last() const {
    auto e =
        the_analysis().analyse({campaign, campaign.measurements.back(), all.back(), options, &all});
    EXPECT_TRUE(e);
    if (e) expect_words(*e);
    return e ? *e : Evaluation{};
  }
  /// Every place in the words has its evidence.
  static void expect_words(const Evaluation& e) {
    static const auto words = word_places("en");
    const auto filled = [&](const std::string& id, const auto& evidence, const auto& texts) {
      const auto places = words.find(id);
      ASSERT_NE(places, words.end()) << id;
      for (const std::string& place : places->second) {
        bool has = false;
        for (const Number& n : evidence) has |= n.name == place;
        for (const auto& [name, text] : texts) has |= name == place;
        EXPECT_TRUE(has) << id << " " << place;
      }
    };
    for (const Finding& f : e.findings)
      if (!f.id.starts_with("uncertainty.")) filled(f.id, f.evidence, f.texts);
    for (const Remark& r : e.notes) filled(r.id, r.evidence, r.texts);
  }
};

const Value* value(const Evaluation& e, std::string_view name) {
  for (const Value& v : e.values)
    if (v.name == name) return &v;
  return nullptr;
}

const Finding* found(const Evaluation& e, std::string_view id) {
  for (const Finding& f : e.findings)
    if (f.id == id) return &f;
  return nullptr;
}

double evidence(const Finding& f, std::string_view name) {
  for (const Number& n : f.evidence)
    if (n.name == name) return n.value;
  ADD_FAILURE() << f.id << " has no " << name;
  return 0.0;
}

std::string ids(const Evaluation& e) {
  std::string out;
  for (const Finding& f : e.findings) out += f.id + " ";
  return out;
}

std::vector<math::BallCentre> noisy(const Table& t, const std::vector<double>& angles, double sigma,
                                    unsigned seed = 7) {
  Noise noise(seed);
  return noise.on(t.at(angles), sigma);
}

/// If another axis also turned, the centres are not on a circle; if it did not, they are.
void other_axis(Workshop& shop, double turned) {
  Observations& o = shop.all.front();
  o.axes.push_back({"B", true, std::vector<double>(o.size(), 0.5), {}});
  o.axes.back().position.back() += turned;
}

/// Refused means: this finding, for attention, and no value.
void expect_refused(const Evaluation& e, std::string_view id) {
  const Finding* f = found(e, id);
  ASSERT_NE(f, nullptr) << "expected " << id << ", found " << ids(e);
  EXPECT_TRUE(f->attention);
  EXPECT_TRUE(e.values.empty());
  EXPECT_TRUE(e.series.empty());
}

/// The manifest has no budget here, and a good measurement has nothing else to say.
bool nothing_else(const Evaluation& e) {
  return std::all_of(e.findings.begin(), e.findings.end(), [](const Finding& f) {
    return f.id == "uncertainty.no-data" || f.id.starts_with("rotary.two-points");
  });
}

/// Everything that a budget needs, but for the linear axes.
void state(Campaign& c) {
  for (const char* name : {"X", "Y", "Z"}) {
    c.machine.axes.push_back(Axis{.name = name});
    c.machine.axes.back().expansion = 11.5e-6;
  }
  c.instrument.U_fixed = c.instrument.sphere = c.instrument.probe = 1 * um;
  c.instrument.U_per_length = 1 * um;
  c.environment.temperature_range = 0.1;
  c.environment.temperature_difference = 1.0;
  c.environment.expansion_range = 1 * um;
  c.environment.drift = 0.5 * um;
}

TEST(RotaryJudge, BothLanguagesSayTheSame) {
  const auto en = word_places("en"), it = word_places("it");
  ASSERT_GE(en.size(), 25U);
  EXPECT_EQ(en, it);
}

/// Two places half a turn apart: their middle moves with a run-out that they cannot show.
TEST(RotaryJudge, SaysWhatTwoPointsWouldHaveSaid) {
  Table t;
  auto centres = t.at(full_turn(8));
  for (const std::size_t pair : {0U, 4U}) centres[pair].at[0] += 20 * um;  // both the same way
  Workshop shop;
  shop.with("sigma_um", 10.0).measured("C", centres);
  const Evaluation e = shop.last();
  const Finding* f = found(e, "rotary.two-points");
  ASSERT_NE(f, nullptr) << ids(e);
  math::Vector3 middle{};
  for (std::size_t k = 0; k < 3; ++k) middle[k] = (centres[0].at[k] + centres[4].at[k]) / 2.0;
  double wanted = 0.0;  // of the middle to the line through the centre
  math::Vector3 c{value(e, "centre_x")->value, value(e, "centre_y")->value,
                  value(e, "centre_z")->value},
      n{value(e, "direction_i")->value, value(e, "direction_j")->value,
        value(e, "direction_k")->value};
  double along = 0.0;
  for (std::size_t k = 0; k < 3; ++k) along += (middle[k] - c[k]) * n[k];
  for (std::size_t k = 0; k < 3; ++k) wanted += std::pow(middle[k] - c[k] - along * n[k], 2);
  EXPECT_NEAR(evidence(*f, "difference"), std::sqrt(wanted), 1e-9);
  EXPECT_GT(evidence(*f, "difference"), 5 * um);
  EXPECT_NEAR(evidence(*f, "U_two"), 2.0 * 10 * um / std::sqrt(2.0), 1e-9);
  EXPECT_EQ(
      found(Workshop().measured("C", noisy(t, full_turn(5), 1 * um)).last(), "rotary.two-points"),
      nullptr)
      << "five places have no pair";
}

/// Two places and the angle between them: exact on an exact axis along a machine axis, whichever
/// way it turns; U covers its error as that of half a turn, times 1/sin of half the angle.
TEST(RotaryJudge, SaysWhatTwoPointsAndAnAngleWouldHaveSaid) {
  for (const double sense : {1.0, -1.0}) {
    Table t;
    t.direction = Eigen::Vector3d(0.0, 0.0, sense);
    const auto centres = t.at(turntable::arc(-1.0, 1.0, 5));
    const Evaluation e = Workshop().with("sigma_um", 10.0).measured("C", centres).last();
    const Finding* f = found(e, "rotary.two-points-angle");
    ASSERT_NE(f, nullptr) << ids(e);
    EXPECT_NEAR(evidence(*f, "difference"), 0.0, 1e-10);
    EXPECT_NEAR(evidence(*f, "U_two"), 2.0 * 10 * um / std::sqrt(2.0) / std::sin(1.0), 1e-9);
    EXPECT_NEAR(evidence(*f, "shift"), 10e-6 * t.radius / (2.0 * std::sin(1.0)), 1e-12);
  }
  int covered = 0;
  constexpr int trials = 2000;
  for (unsigned seed = 0; seed < trials; ++seed) {
    Table t;
    t.direction = Eigen::Vector3d::UnitZ();
    Noise noise(seed);
    const auto two = noise.on(t.at({-1.0, 1.0}), 10 * um);
    const double x =
        (two[0].at[0] + two[1].at[0]) / 2.0 - 0.5 / std::tan(1.0) * (two[1].at[1] - two[0].at[1]);
    covered += std::fabs(x - t.centre[0]) <= 2.0 * 10 * um / std::sqrt(2.0) / std::sin(1.0);
  }
  RecordProperty("covered", covered);
  EXPECT_GT(covered, 0.935 * trials);
  EXPECT_LT(covered, 0.97 * trials);
}

TEST(RotaryJudge, AGoodTableHasCentreAndDirectionAndNoFinding) {
  Table t;
  const Evaluation e = Workshop().measured("C", noisy(t, full_turn(8), 1 * um)).last();
  EXPECT_TRUE(nothing_else(e)) << ids(e);
  for (std::size_t k = 0; k < 3; ++k) {
    const Value* c = value(e, std::string("centre_") + "xyz"[k]);
    ASSERT_NE(c, nullptr);
    EXPECT_NEAR(c->value, t.centre[static_cast<int>(k)], 3 * um);
    EXPECT_FALSE(c->U);
    EXPECT_GT(*c->repeatability, 0.2 * um);
    EXPECT_LT(*c->repeatability, 3 * um);
    ASSERT_NE(value(e, std::string("direction_") + "ijk"[k]), nullptr);
  }
  EXPECT_NEAR(value(e, "radius")->value, t.radius, 2 * um);
  ASSERT_EQ(e.series.size(), 2U);
  EXPECT_EQ(e.series[0].position.size(), 8U);
}

TEST(RotaryJudge, RefusesWhatIsNoAxis) {
  Table t;
  const auto evaluated = [](std::vector<math::BallCentre> c) {
    return Workshop().measured("C", c).last();
  };
  expect_refused(evaluated(t.at(full_turn(2))), "rotary.too-few");
  auto repeated = t.at({0, 1, 2, 3, 1});
  expect_refused(evaluated(repeated), "rotary.repeated-angles");
  auto line = t.at(full_turn(5));
  for (std::size_t i = 0; i < 5; ++i) line[i].at = {0.05 * static_cast<double>(i), 0, 0};
  expect_refused(evaluated(line), "rotary.collinear");
  auto same = t.at(full_turn(5));
  for (auto& c : same) c.at = {1, 2, 3};
  expect_refused(evaluated(same), "rotary.collinear");
  auto huge = t.at(full_turn(5));
  huge[1].at[2] = 1e12;
  expect_refused(evaluated(huge), "rotary.not-finite");
  huge[1].at[2] = std::numeric_limits<double>::quiet_NaN();
  expect_refused(evaluated(huge), "rotary.not-finite");
  huge[1].angle = std::numeric_limits<double>::quiet_NaN();
  expect_refused(evaluated(huge), "rotary.repeated-angles");
  auto shuffled = t.at(full_turn(8));
  std::swap(shuffled[0].at, shuffled[3].at);
  expect_refused(evaluated(shuffled), "rotary.angles-disagree");
}

TEST(RotaryJudge, CentresThatAreNoCircleAreRefused) {
  Table t;
  auto square = t.at(full_turn(8));
  for (std::size_t i = 0; i < 8; i += 2)
    for (std::size_t k = 0; k < 2; ++k)
      square[i].at[k] += 0.01 * (square[i].at[k] - t.centre[static_cast<int>(k)]);
  expect_refused(Workshop().measured("C", square).last(), "rotary.not-a-circle");
  // Against a stated sigma.
  const auto rough = noisy(t, full_turn(8), 30 * um);
  EXPECT_EQ(found(Workshop().measured("C", rough).last(), "rotary.not-a-circle"), nullptr);
  expect_refused(Workshop().with("sigma_um", 1.0).measured("C", rough).last(),
                 "rotary.not-a-circle");
}

TEST(RotaryJudge, ThreeCentresNeedAStatedSigmaAndSquarenessForU) {
  Table t;
  const auto three = noisy(t, full_turn(3), 2 * um);
  for (const auto& [given, why] :
       {std::pair{Workshop().measured("C", three).last(), "rotary.sigma-needed"},
        std::pair{Workshop().with("sigma_um", 2.0).measured("C", three).last(),
                  "rotary.three-points-squareness"}}) {
    ASSERT_NE(found(given, why), nullptr) << ids(given);
    ASSERT_EQ(given.values.size(), 7U);
    for (const Value& v : given.values) EXPECT_FALSE(v.U || v.repeatability) << v.name;
    EXPECT_NEAR(value(given, "radius")->value, t.radius, 8 * um);
    // The circle through three points is exact: each of them has the same distance.
    for (const auto& c : three) {
      double squares = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
        squares += std::pow(c.at[i] - value(given, std::string("centre_") + "xyz"[i])->value, 2);
      EXPECT_NEAR(std::sqrt(squares), value(given, "radius")->value, 1e-12);
    }
  }
  // On less than half a turn nothing shows whether U would be small enough.
  expect_refused(Workshop().measured("C", noisy(t, arc(0, 50 * deg, 3), 2 * um)).last(),
                 "rotary.sigma-needed");
  const Evaluation e =
      Workshop().with("sigma_um", 2.0).with("linear_axes_urad", 10.0).measured("C", three).last();
  ASSERT_NE(found(e, "rotary.three-points"), nullptr) << ids(e);
  EXPECT_NEAR(*value(e, "centre_x")->repeatability, 2 * 2 * um * std::sqrt(2.0 / 3.0), 0.01 * um);
  EXPECT_EQ(value(e, "s"), nullptr);
  // The instrument's certificate will do for sigma.
  Workshop certified;
  certified.campaign.instrument.U_fixed = 4 * um;
  const Evaluation same = certified.with("linear_axes_urad", 10.0).measured("C", three).last();
  EXPECT_NEAR(*value(same, "centre_x")->repeatability, *value(e, "centre_x")->repeatability, 1e-9);
}

TEST(RotaryJudge, AShortArcIsRefusedUnlessTheToleranceAllowsIt) {
  Table t;
  const auto part = noisy(t, arc(0, 30 * deg, 11), 10 * um);
  const Evaluation e = Workshop().measured("B", part).last();
  expect_refused(e, "rotary.short-arc");
  const Finding& f = *found(e, "rotary.short-arc");
  EXPECT_NEAR(evidence(f, "arc"), 30 * deg, 0.02);
  EXPECT_GT(evidence(f, "U"), 200 * um);
  EXPECT_FALSE(Workshop().with("tolerance_um", 5000.0).measured("B", part).last().values.empty());
}

TEST(RotaryJudge, AdviceSaysByHowMuch) {
  Table t;
  t.radius = 0.05;
  const Evaluation e = Workshop()
                           .with("sigma_um", 10.0)
                           .with("tolerance_um", 5.0)
                           .with("tolerance_urad", 50.0)
                           .measured("C", noisy(t, full_turn(8), 10 * um))
                           .last();
  const Finding* more = found(e, "rotary.more-points");
  ASSERT_NE(more, nullptr) << ids(e);
  // U = 2 * 10 sqrt(2/8) = 10 um: four times as many points halve it.
  EXPECT_NEAR(evidence(*more, "U"), 10 * um, 0.01 * um);
  EXPECT_NEAR(evidence(*more, "wanted"), 32, 1);
  const Finding* larger = found(e, "rotary.larger-radius");
  ASSERT_NE(larger, nullptr) << ids(e);
  EXPECT_NEAR(evidence(*larger, "U"), 200 * urad, 1 * urad);
  EXPECT_NEAR(evidence(*larger, "radius_wanted"), 0.2, 0.001);
  EXPECT_NEAR(evidence(*larger, "wanted"), 128, 1);
}

TEST(RotaryJudge, EllipseAndAxialRunOut) {
  Table t;
  t.radius = 0.5;
  t.linear_axes(0, 1) = 40 * urad;
  auto centres = noisy(t, full_turn(8), 0.5 * um);
  const Evaluation e = Workshop().measured("C", centres).last();
  const Finding* ellipse = found(e, "rotary.ellipse");
  ASSERT_NE(ellipse, nullptr) << ids(e);
  EXPECT_NEAR(evidence(*ellipse, "shear"), 40 * urad, 4 * urad);
  EXPECT_EQ(found(e, "rotary.axial-run-out"), nullptr);
  t.linear_axes.setIdentity();
  centres = noisy(t, full_turn(8), 0.5 * um);
  for (auto& c : centres) c.at[2] += 6 * um * std::cos(2 * (c.angle - 20 * deg));
  const Evaluation wobble = Workshop().measured("C", centres).last();
  const Finding* axial = found(wobble, "rotary.axial-run-out");
  ASSERT_NE(axial, nullptr) << ids(wobble);
  EXPECT_NEAR(evidence(*axial, "amplitude"), 6 * um, 1 * um);
  EXPECT_NEAR(evidence(*axial, "at"), 20 * deg, 4 * deg);
  EXPECT_EQ(found(wobble, "rotary.ellipse"), nullptr);
}

/// Three points of a full turn take a squareness for a shift of the centre by half of it times the
/// radius, the instrument's fixed part and the probe go into the centre undiminished, and what both
/// circles have in common is no distance between them.
TEST(RotaryJudge, TheBudgetHasEveryContribution) {
  Table t;
  Workshop w;
  state(w.campaign);
  w.with("sigma_um", 2.0).with("linear_axes_urad", 10.0);
  const Evaluation e = Workshop(w).measured("C", noisy(t, full_turn(3), 2 * um)).last();
  EXPECT_EQ(found(e, "uncertainty.no-data"), nullptr);
  ASSERT_TRUE(e.budget);
  const auto part = [&](const std::string& name, const std::string& id) {
    for (const auto& r : e.budget->results)
      for (std::size_t i = 0; r.name == name && i < r.u.size(); ++i)
        if (e.budget->contributions[i].id == id) return r.u[i];
    ADD_FAILURE() << name << " " << id;
    return 0.0;
  };
  EXPECT_NEAR(part("centre_x", "repetition"), 2 * um * std::sqrt(2.0 / 3.0), 1e-9);
  EXPECT_NEAR(part("centre_x", "device-fixed"), 0.5 * um, 1e-10);
  EXPECT_NEAR(part("centre_x", "probe"), 1 * um / std::sqrt(12.0), 1e-10);
  EXPECT_NEAR(part("centre_x", "sphere"), 1 * um / std::sqrt(12.0) * std::sqrt(2.0 / 3.0), 1e-9);
  // Of shear and of both scales: each half of it times the radius, but the scales as a difference.
  const double half = 0.261 * 10e-6 / std::sqrt(3.0) / 2.0;
  EXPECT_GT(part("centre_x", "linear-axes"), half * 0.9);
  EXPECT_LT(part("centre_x", "linear-axes"), half * 1.5);
  EXPECT_NEAR(part("direction_i", "device-fixed"), 0.0, 1e-12);
  const Value& x = *value(e, "centre_x");
  double sum = 0.0;
  for (const auto& r : e.budget->results)
    if (r.name == "centre_x")
      for (const double u : r.u) sum += u * u;
  EXPECT_NEAR(*x.U, x.k * std::sqrt(sum), 1e-12);

  Table b;
  b.centre = {0.12, 0.3, 0.05};
  b.direction = {0, 1, 0};
  const auto distance = [&](double probe) {
    Workshop two = w;
    two.campaign.instrument.probe = probe;
    two.measured("C", noisy(t, full_turn(8), 1 * um))
        .measured("B", noisy(b, full_turn(12), 1 * um));
    return *value(two.with("same_reference", std::vector<std::string>{"C", "B"}).last(),
                  "distance_C")
                ->U;
  };
  EXPECT_NEAR(distance(1 * um), distance(50 * um), 1e-9);
}

/// 2,000 tables without ellipse or wobble: each is accused as often as its level says.
TEST(RotaryJudge, FalseAlarmsAreAsRareAsTheirLevel) {
  const unsigned seed = 99;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Noise noise(seed);
  const Table t;
  int ellipse = 0, axial = 0, suspect = 0;
  for (int i = 0; i < 2000; ++i) {
    const Evaluation e = Workshop().measured("C", noise.on(t.at(full_turn(8)), 1 * um)).last();
    ellipse += found(e, "rotary.ellipse") != nullptr;
    axial += found(e, "rotary.axial-run-out") != nullptr;
    suspect += found(e, "rotary.suspect-centre") != nullptr;
  }
  EXPECT_GE(ellipse, 5);  // 20 expected of 2,000 at 1 %
  EXPECT_LE(ellipse, 38);
  EXPECT_GE(axial, 5);
  EXPECT_LE(axial, 38);
  EXPECT_GE(suspect, 5);
  EXPECT_LE(suspect, 38);
}

TEST(RotaryJudge, AMisprobedCentreIsNamed) {
  const unsigned seed = 101;
  Noise noise(seed);
  const Table t;
  int named = 0;
  for (int i = 0; i < 200; ++i) {
    auto centres = noise.on(t.at(full_turn(12)), 1 * um);
    centres[5].at[static_cast<std::size_t>(i % 3)] += 15 * um;
    const Evaluation e = Workshop().measured("C", centres).last();
    const Finding* f = found(e, "rotary.suspect-centre");
    named += f != nullptr && std::fabs(evidence(*f, "angle") - centres[5].angle) < 1e-6;
  }
  EXPECT_GE(named, 120) << "seed " << seed;  // along the path of the ball nothing shows it
}

TEST(RotaryJudge, ScatterBeyondTheStatedSigma) {
  Table t;
  const auto rough = noisy(t, full_turn(8), 5 * um);
  const Evaluation e = Workshop().with("sigma_um", 1.0).measured("C", rough).last();
  ASSERT_NE(found(e, "rotary.scatter"), nullptr) << ids(e);
  const Evaluation own = Workshop().measured("C", rough).last();
  // From the residuals.
  EXPECT_EQ(*value(e, "centre_x")->repeatability, *value(own, "centre_x")->repeatability);
}

/// What centres state of themselves is not lost: U is never less than it makes.
TEST(RotaryJudge, TheUncertaintyOfTheCentresCounts) {
  Table t;
  const auto centres = noisy(t, full_turn(8), 1 * um);
  const auto with = [&](double u) {
    Workshop w = Workshop().measured("C", centres);
    w.all.back().u.assign(w.all.back().deviation.size(), u);
    return w.last();
  };
  const auto of = [](const Evaluation& e) { return *value(e, "centre_x")->repeatability; };
  const double alone = of(Workshop().measured("C", centres).last());
  const Evaluation small = with(0.01 * um), large = with(20 * um);
  EXPECT_EQ(of(small), alone);
  EXPECT_GT(of(large), 5 * alone);
  EXPECT_NEAR(of(with(40 * um)) / of(large), 2.0, 1e-9);
  EXPECT_NE(found(large, "rotary.stated-uncertainty"), nullptr) << ids(large);
  EXPECT_EQ(found(Workshop().measured("C", centres).last(), "rotary.stated-uncertainty"), nullptr);
}

TEST(RotaryJudge, AnglesThatDoNotDeserveTrust) {
  Table t;
  auto centres = noisy(t, full_turn(12), 1 * um);
  for (std::size_t i = 0; i < centres.size(); ++i)
    centres[i].angle += 100 * urad * std::sin(3.0 * static_cast<double>(i));  // 26 um at R
  EXPECT_NE(found(Workshop().with("use_angles", true).measured("C", centres).last(),
                  "rotary.angles-not-trusted"),
            nullptr);
  EXPECT_TRUE(nothing_else(Workshop().measured("C", centres).last()));
  const auto good = noisy(t, full_turn(12), 1 * um);
  EXPECT_EQ(found(Workshop().with("use_angles", true).measured("C", good).last(),
                  "rotary.angles-not-trusted"),
            nullptr);
}

TEST(RotaryJudge, ArcsSayWhatSquarenessDoes) {
  Table t;
  const auto part = noisy(t, arc(-60 * deg, 90 * deg, 11), 1 * um);
  const Evaluation e = Workshop().measured("B", part).last();
  const Finding* f = found(e, "rotary.arc-squareness");
  ASSERT_NE(f, nullptr) << ids(e);
  EXPECT_GT(evidence(*f, "shift"), 2 * um);
  EXPECT_LT(evidence(*f, "shift"), 4 * um);
  const Evaluation bounded = Workshop().with("linear_axes_urad", 10.0).measured("B", part).last();
  EXPECT_EQ(found(bounded, "rotary.arc-squareness"), nullptr);
  const auto whole = [&](double bound) {
    Workshop w;
    state(w.campaign);
    return *value(w.with("linear_axes_urad", bound).measured("B", part).last(), "centre_x")->U;
  };
  EXPECT_GT(whole(10.0), 1.1 * whole(1.0));
}

TEST(RotaryJudge, RunsAtOneAngleAreOneCentre) {
  Table t;
  auto all = noisy(t, full_turn(8), 2 * um, 1);
  const auto second = noisy(t, full_turn(8), 2 * um, 2);
  all.insert(all.end(), second.begin(), second.end());
  Workshop w;
  w.measured("C", all);
  for (std::size_t i = 0; i < w.all[0].run.size(); ++i) w.all[0].run[i] = i < 24 ? 1 : 2;
  const Evaluation e = w.last();
  ASSERT_EQ(e.points.column("n")->values.size(), 8U);
  EXPECT_EQ(e.points.column("n")->values[3], 2.0);
  // A full turn on, the axis is where it was.
  auto closed = noisy(t, full_turn(8), 2 * um);
  closed.push_back(noisy(t, {360 * deg}, 2 * um, 9)[0]);
  const Evaluation turn = Workshop().measured("C", closed).last();
  EXPECT_EQ(turn.points.column("n")->values[0], 2.0);
  EXPECT_EQ(turn.points.column("n")->values.size(), 8U);
}

TEST(RotaryJudge, AxesAreComparedOnlyWithOneReference) {
  Table c, b;
  b.centre = {0.12, 0.3, 0.05};
  b.direction = {0, 1, 0};
  const auto workshop = [&] {
    Workshop w;
    w.measured("C", noisy(c, full_turn(8), 1 * um)).measured("B", noisy(b, full_turn(12), 1 * um));
    return w;
  };
  const Evaluation apart = workshop().last();
  EXPECT_EQ(value(apart, "distance_C"), nullptr);
  EXPECT_NE(found(apart, "rotary.reference-unknown"), nullptr);
  EXPECT_TRUE(apart.uses.empty());
  const Evaluation e = workshop().with("same_reference", std::vector<std::string>{"C", "B"}).last();
  ASSERT_NE(value(e, "distance_C"), nullptr) << ids(e);
  EXPECT_NEAR(value(e, "distance_C")->value, 0.12 - 0.102532,
              *value(e, "distance_C")->repeatability * 2);
  EXPECT_NEAR(value(e, "angle_C")->value, 90 * deg, *value(e, "angle_C")->repeatability * 2);
  EXPECT_EQ(e.uses, std::vector<std::string>{"C"});
  EXPECT_EQ(found(e, "rotary.reference-unknown"), nullptr);
}

TEST(Rotary, AMeasurementOfTwoAxesIsNoCircle) {
  for (const bool turned : {false, true}) {
    Workshop shop;
    shop.measured("C", noisy(Table{}, full_turn(8), 1 * um));
    other_axis(shop, turned ? 0.1 : 0.0);
    const Evaluation e = shop.last();
    EXPECT_EQ(found(e, "rotary.other-axis-turned") != nullptr, turned) << ids(e);
    EXPECT_EQ(e.values.empty(), turned);
  }
}

}  // namespace
}  // namespace nonio
