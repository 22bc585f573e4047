// SPDX-License-Identifier: Apache-2.0
//
// Balls of artefacts and squares in the fit of all errors, against the exact machine.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <map>

#include "artefact_workshop.h"

namespace nonio::math::rigid_artefact_test {
namespace {

using namespace rigid_workshop;

constexpr double um = 1e-6;
constexpr int balls_a_side = 3;

/// The box that the balls fill: straightness has no slope over it, angles no constant.
std::pair<Vector, Vector> filled() {
  Vector from = Vector::Constant(INFINITY), to = -from;
  for (const Pose& pose : poses_of_plate())
    for (const Vector& ball : plate(balls_a_side, 0.5)) {
      const Vector at = pose.turn * ball + pose.shift;
      from = from.cwiseMin(at), to = to.cwiseMax(at);
    }
  return {from, to};
}

/// Errors of first and second degree: what nine balls a placement tell.
Truth smooth_machine(std::mt19937_64& random, double um_, double urad) {
  Truth t = any_machine(random, um_, urad);
  const auto [from, to] = filled();
  for (auto& [name, c] : t.of) {
    c[2] = c[3] = 0.0;
    const auto axis = static_cast<Eigen::Index>(axis_of(name));
    const double start = from[axis], length = to[axis] - start;
    t.errors[name] = [c = c, start, length](double at) {
      const double part = 2.0 * (at - start) / length - 1.0;
      return c[0] * legendre4(1, part) + c[1] * legendre4(2, part);
    };
  }
  t.errors.y_ref = (from[1] + to[1]) / 2.0;
  t.errors.z_ref = (from[2] + to[2]) / 2.0;
  return t;
}

/// The error vectors of the map against those of the exact machine, both less those of the middle
/// of the map's box.
Corner exact_node(const Truth& t, const Evaluation& e, std::size_t row) {
  const auto& columns = e.rows.columns;
  machine::Vector at, low_of, high_of;
  for (int k = 0; k < 3; ++k) {
    const auto& place = columns[static_cast<std::size_t>(k)].values;
    at[k] = place[row];
    low_of[k] = *std::min_element(place.begin(), place.end());
    high_of[k] = *std::max_element(place.begin(), place.end());
  }
  const machine::Vector middle = (low_of + high_of) / 2.0;
  const machine::Vector d =
      machine::point(t.errors, at) - at - (machine::point(t.errors, middle) - middle);
  return {d[0], d[1], d[2]};
}

void expect_exact(const Truth& t, const Evaluation& e, double within) {
  ASSERT_GE(e.rows.columns.size(), 6u);
  for (std::size_t row = 0; row < e.rows.columns[0].values.size(); ++row) {
    const Corner exact = exact_node(t, e, row);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(e.rows.columns[3 + k].values[row], exact[k], within) << row << " " << k;
  }
}

Workshop with_plate(const Truth& t, const std::vector<Vector>& balls, const Noise& noise,
                    int runs = 1) {
  Workshop w;
  for (const Pose& pose : poses_of_plate())
    w.add(pose.id, "artefact", probed_on(t, balls, pose, noise, runs));
  return w;
}

/// What first order leaves out, and how much of it the weakest unknowns make of it.
constexpr double second_order = 0.09 * um, second_order_angle = 0.2e-6;

Observations run_of_axis(const Truth& t, std::size_t axis, const Noise& noise) {
  const auto [first, last] = filled();
  Corner from = place(.5, .5, .5), to = from;
  const auto k = static_cast<Eigen::Index>(axis);
  from[axis] = first[k], to[axis] = last[k];
  const RigidLine line = beam(t, from, to, 16, 2, noise);
  Observations o;
  o.axes = {{std::string(1, "XYZ"[axis]), false, {}, {}}};
  Observations::Line sensed{"beam", {}};
  sensed.sense[axis] = 1.0;
  o.lines = {sensed};
  std::uint32_t row = 0;
  for (const RigidReading& r : line.readings) {
    o.axes[0].position.push_back(r.at[axis]);
    o.axes[0].approach.push_back(static_cast<std::int8_t>(r.way));
    o.deviation.push_back(r.value);
    o.run.push_back(row / 34 + 1);
    o.line.push_back(0);
    o.source_line.push_back(++row + 1);
  }
  return o;
}

Measurement& add_axis(Workshop& w, const Truth& t, std::size_t axis, const Noise& noise) {
  Measurement& m = w.add(std::string(1, "XYZ"[axis]), "axis", run_of_axis(t, axis, noise));
  m.axis = std::string(1, "XYZ"[axis]);
  for (std::size_t k = 0; k < 3; ++k)
    if (k != axis) m.at[std::string(1, "XYZ"[k])] = place(.5, .5, .5)[k];
  return m;
}

Evaluation done(const Workshop& w) {
  auto e = w.done();
  EXPECT_TRUE(e) << (e ? "" : e.error().message);
  return e ? *e : Evaluation{};
}

TEST(Artefact, APlateInNinePlacesDeterminesTheVolume) {
  std::mt19937_64 random(20261130);
  for (int i = 0; i < 3; ++i) {
    const Truth t = smooth_machine(random, 10, 15);
    const auto balls = plate(balls_a_side, 0.5);
    Workshop w = with_plate(t, balls, {});
    w.add("certificate", "artefact-certificate", certificate_of(balls, 0.1 * um));
    const Evaluation e = done(w);
    EXPECT_EQ(found(e, "rigid-body.not-separable"), nullptr);
    EXPECT_EQ(found(e, "uncertainty.no-data"), nullptr);
    expect_exact(t, e, second_order);
    ASSERT_NE(value(e, "C0Y_all"), nullptr);
    EXPECT_NEAR(value(e, "C0Y_all")->value, t.errors.C0Y, second_order_angle);
    EXPECT_NEAR(value(e, "B0Z_all")->value, t.errors.B0Z, second_order_angle);
    EXPECT_NEAR(value(e, "A0Z_all")->value, t.errors.A0Z, second_order_angle);
  }
}

TEST(Artefact, WithoutACertificateTheScaleIsMissingAndALaserBringsIt) {
  std::mt19937_64 random(20261131);
  const Truth t = smooth_machine(random, 10, 15);
  auto balls = plate(balls_a_side, 0.5);
  for (Vector& b : balls) b += 30 * um * Vector::Random();
  Workshop w = with_plate(t, balls, {});
  const Evaluation alone = done(w);
  const Finding* open = found(alone, "rigid-body.not-separable");
  ASSERT_NE(open, nullptr);
  EXPECT_EQ(open->evidence.front().value, 1.0);  // one combination: all three scales alike
  EXPECT_NE(open->texts.front().second.find("EZZ.1"), std::string::npos)
      << open->texts.front().second;
  EXPECT_NE(open->texts.front().second.find("EXX.1"), std::string::npos);
  EXPECT_TRUE(alone.rows.columns.empty());
  add_axis(w, t, 0, {});
  const Evaluation with_x = done(w);
  EXPECT_EQ(found(with_x, "rigid-body.not-separable"), nullptr);
  expect_exact(t, with_x, second_order);
}

TEST(Artefact, OneLengthOfItsCertificateBringsTheScaleToo) {
  std::mt19937_64 random(20261132);
  const Truth t = smooth_machine(random, 10, 15);
  auto balls = plate(balls_a_side, 0.5);
  for (Vector& b : balls) b += 30 * um * Vector::Random();
  Workshop w = with_plate(t, balls, {});
  Observations lengths;
  lengths.axes = {{"certificate", false, {1.0}, {}}};
  lengths.lines = {{"b1 b9", {}}};
  lengths.deviation = {(balls[0] - balls[8]).norm()};
  lengths.u = {0.1 * um};
  lengths.line = {0}, lengths.run = {1}, lengths.source_line = {2};
  w.add("certificate", "artefact-certificate", lengths);
  expect_exact(t, done(w), second_order);
}

enum class Heights { not_read, zero };

/// A plate of holes in the plane of X and Y, turned four ways.
Workshop with_holes(const Truth& t, const Noise& noise, Heights heights) {
  const auto holes = plate(4, 0.3);
  Workshop w;
  for (int turned = 0; turned < 4; ++turned) {
    Pose pose;
    pose.id = "H" + std::to_string(turned);
    pose.turn = Eigen::AngleAxisd(turned * std::numbers::pi / 2 + 0.002, Vector::UnitZ()).matrix();
    pose.shift = Vector(0.4, 0.3, 0.25) - pose.turn * Vector(0.15, 0.15, 0.0);
    Observations o = probed_on(t, holes, pose, noise, 2);
    const bool zeros = heights == Heights::zero;
    Observations kept = o;
    for (auto& axis : kept.axes) axis.position.clear();
    kept.deviation.clear(), kept.line.clear(), kept.run.clear(), kept.source_line.clear();
    if (!zeros) kept.axes.pop_back();
    for (std::size_t i = 0; i < o.size(); ++i) {
      const bool height = o.sense_of(i)[2] != 0.0;
      if (height && !zeros) continue;
      for (std::size_t c = 0; c < kept.axes.size(); ++c)
        kept.axes[c].position.push_back(c == 2 ? 0.0 : o.axes[c].position[i]);
      kept.deviation.push_back(height ? 0.0 : o.deviation[i]);
      kept.line.push_back(o.line[i]);
      kept.run.push_back(o.run[i]);
      kept.source_line.push_back(o.source_line[i]);
    }
    if (!zeros)  // as the reader has them: no line of what was not measured
      for (std::size_t b = holes.size(); b-- > 0;) {
        kept.lines.erase(kept.lines.begin() + static_cast<std::ptrdiff_t>(3 * b + 2));
        for (auto& line : kept.line)
          if (line > 3 * b + 2) --line;
      }
    w.add(pose.id, "artefact", kept);
  }
  return w;
}

double of_note(const Evaluation& e, std::string_view id, std::string_view name) {
  for (const Remark& note : e.notes)
    if (note.id == id)
      for (const Number& n : note.evidence)
        if (n.name == name) return n.value;
  return NAN;
}

TEST(Artefact, ACoordinateThatWasNotMeasuredIsNoReading) {
  std::mt19937_64 random(20261128);
  double inside = 0.0, ratio = 0.0;
  constexpr int campaigns = 40;
  for (int i = 0; i < campaigns; ++i) {
    const Truth t = smooth_machine(random, 0, 0);  // squareness alone
    const Noise noise{&random, 1.0 * um};
    const Evaluation e = done(with_holes(t, noise, Heights::not_read));
    EXPECT_EQ(found(e, "rigid-body.artefact-does-not-fit"), nullptr);
    EXPECT_EQ(of_note(e, "rigid-body.fit", "readings"), 4 * 16 * 2);
    // Without a certificate the scatter of the places must not seem to tell the scale.
    for (const Series& s : e.series)
      for (const double v : s.value) EXPECT_LT(std::fabs(v), 100 * um) << s.name;
    const Value* C0Y = value(e, "C0Y_all");
    ASSERT_NE(C0Y, nullptr);
    ASSERT_TRUE(C0Y->U);
    inside += std::fabs(C0Y->value - t.errors.C0Y) <= *C0Y->U + second_order_angle ? 1.0 : 0.0;
    const Evaluation invented = done(with_holes(t, noise, Heights::zero));
    EXPECT_EQ(of_note(invented, "rigid-body.fit", "readings"), 4 * 16 * 3);
    if (const Value* other = value(invented, "C0Y_all"); other != nullptr && other->U)
      ratio += *other->U / *C0Y->U / campaigns;
  }
  std::cout << "C0Y covered in " << inside << " of " << campaigns
            << "; U with heights of zero as readings is " << ratio << " of it\n";
  EXPECT_GE(inside, 0.85 * campaigns);
}

TEST(Artefact, ABallThatIsAnotherOneIsRefusedByName) {
  std::mt19937_64 random(20261133);
  const Truth t = smooth_machine(random, 10, 15);
  auto balls = plate(balls_a_side, 0.5);
  Workshop w = with_plate(t, balls, {});
  std::swap(balls[1], balls[3]);  // the plate is symmetric: mirrored numbers
  balls[1] += Vector(0.0, 0.0, 0.001);
  w.add("certificate", "artefact-certificate", certificate_of(balls, 0.1 * um));
  const Evaluation e = done(w);
  const Finding* f = found(e, "rigid-body.artefact-does-not-fit");
  ASSERT_NE(f, nullptr);
  EXPECT_GT(f->evidence.front().value, artefact_limit);
  EXPECT_TRUE(e.values.empty());
}

TEST(Artefact, PlacementsThatShareTooFewBallsAreNotLinked) {
  Artefact a;
  for (const char* name : {"1", "2", "3", "4", "5"}) a.balls.push_back({.name = name});
  a.placements = {{"A", {0, 1, 2}, {{0, 0, 0}, {.1, 0, 0}, {0, .1, 0}}},
                  {"B", {0, 1, 3, 4}, {{0, 0, 0}, {.1, 0, 0}, {.3, .1, 0}, {.2, .1, .1}}}};
  const auto lines = artefact_lines(a, 0, 0);
  ASSERT_FALSE(lines);
  EXPECT_EQ(lines.error().why, ArtefactRefusal::Why::not_linked);
  EXPECT_EQ(lines.error().placement, "B");
  a.placements[1].ball[2] = 2;  // three in common, not on one line, and each where it was
  a.placements[1].at[2] = {0, .1, 0};
  EXPECT_TRUE(artefact_lines(a, 0, 0));
}

/// X towards Y and Y towards X on one square that is misaligned, then turned over.
void add_square(Workshop& w, const Truth& t, double g, double askew, double askew_turned,
                const Noise& noise, bool turned) {
  const auto add = [&](const char* id, std::size_t axis, std::size_t across, double leans,
                       bool over) {
    Measurement& m = w.add(id, "straightness", on_face(t, axis, across, filled(), leans, 2, noise));
    m.axis = std::string(1, "XYZ"[axis]);
    m.lateral = std::string(1, "XYZ"[across]);
    m.square = "Q";
    m.square_turned = over;
    for (const char k : {'X', 'Y', 'Z'})
      if (std::string(1, k) != m.axis) m.at[std::string(1, k)] = k == 'X' ? 0.4 : 0.3;
  };
  add("QX", 0, 1, askew, false);
  add("QY", 1, 0, -askew + g, false);
  if (!turned) return;
  add("QX-over", 0, 1, askew_turned, true);
  add("QY-over", 1, 0, -askew_turned - g, true);
}

TEST(Squares, ASquareDeterminesC0YTurnedOverOrByItsCertificate) {
  std::mt19937_64 random(20261134);
  const Truth t = smooth_machine(random, 10, 0);
  for (const bool turned : {true, false}) {
    Workshop w;
    w.with("errors", std::vector<std::string>{"EXX", "EYY", "EYX", "EXY", "C0Y"});
    w.campaign.squares = {{.name = "Q"}};
    if (!turned) w.campaign.squares.front().error = 21e-6, w.campaign.squares.front().U = 1e-6;
    add_axis(w, t, 0, {});
    add_axis(w, t, 1, {});
    add_square(w, t, 21e-6, 150e-6, -80e-6, {}, turned);
    const Evaluation e = done(w);
    ASSERT_NE(value(e, "C0Y_all"), nullptr) << turned;
    EXPECT_NEAR(value(e, "C0Y_all")->value, t.errors.C0Y, 0.1e-6) << turned;
    ASSERT_TRUE(value(e, "C0Y_all")->U);
    if (!turned) {
      EXPECT_NEAR(*value(e, "C0Y_all")->U, 1e-6, 0.02e-6);
    }
  }
}

TEST(Squares, WithoutItsErrorASquareDeterminesNothing) {
  std::mt19937_64 random(20261135);
  const Truth t = smooth_machine(random, 10, 0);
  Workshop w;
  w.with("errors", std::vector<std::string>{"EXX", "EYY", "EYX", "EXY", "C0Y"});
  w.campaign.squares = {{.name = "Q"}};
  add_axis(w, t, 0, {});
  add_square(w, t, 21e-6, 150e-6, 0.0, {}, false);
  EXPECT_FALSE(w.done());  // applies to nothing
}

struct Coverage {
  std::size_t in = 0, of = 0;
  void see(double error, double U) { in += std::fabs(error) <= U ? 1 : 0, ++of; }
  double percent() const { return 100.0 * static_cast<double>(in) / static_cast<double>(of); }
};

/// One campaign: a plate as its certificate does not know it, its scale, a square, a laser.
struct Scenario {
  const char* name;
  double s, U_ball, U_scale, K;  ///< scatter, certificate, scale, range of the thermometers
  bool laser, square, certificate = true;
  bool turned = false;  ///< the square turned over, in place of its certificate
};

Workshop campaign_of(const Scenario& scenario, const Truth& t, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(-0.5, 0.5);
  const Noise noise{&random, scenario.s};
  const auto stated = plate(balls_a_side, 0.5);
  const double alpha = 11.5e-6,
               scale = scenario.U_scale / 2.0 * normal(random) + alpha * scenario.K * even(random);
  auto balls = stated;
  for (Vector& b : balls) {
    for (int k = 0; k < 3; ++k) b[k] += scenario.U_ball / 2.0 * normal(random);
    b *= 1.0 + scale;
  }
  const double machine_thermometer = alpha * scenario.K * even(random);
  Workshop w;
  for (const Pose& pose : poses_of_plate())
    w.add(pose.id, "artefact", probed_on(t, balls, pose, noise, 2, -machine_thermometer));
  if (scenario.certificate)
    w.add("certificate", "artefact-certificate", certificate_of(stated, scenario.U_ball / 2.0));
  w.campaign.environment.temperature_range = scenario.K;
  w.with("artefact_U_per_m_um", scenario.U_scale * 1e6);
  w.with("artefact_temperature_range_K", scenario.K);
  if (scenario.laser) add_axis(w, t, 0, noise);
  if (scenario.turned) {
    w.campaign.squares = {{.name = "Q"}};
    add_square(w, t, 30e-6 * normal(random), 150e-6 * normal(random), 150e-6 * normal(random),
               noise, true);
  } else if (scenario.square) {
    w.campaign.squares = {{.name = "Q", .error = 0.0, .U = 2e-6}};
    add_square(w, t, 1e-6 * normal(random), 150e-6 * normal(random), 0.0, noise, false);
  }
  return w;
}

void see(const Scenario& scenario, const Truth& t, const Evaluation& e, std::mt19937_64& random,
         std::map<std::string, Coverage>& covered) {
  const std::string name = std::string(scenario.name) + ": ";
  const std::map<std::string, double> truth{
      {"C0Y_all", t.errors.C0Y}, {"B0Z_all", t.errors.B0Z}, {"A0Z_all", t.errors.A0Z}};
  for (const auto& [angle, exact] : truth)
    if (const Value* v = value(e, angle); v != nullptr && v->U)
      covered[name + "squareness"].see(v->value - exact, *v->U);
  ASSERT_EQ(e.rows.columns.size(), 9u);
  const std::size_t row = random() % e.rows.columns[0].values.size();
  const Corner exact = exact_node(t, e, row);
  for (std::size_t k = 0; k < 3; ++k)
    if (const double U = e.rows.columns[6 + k].values[row]; U > 1e-9)  // not of the middle
      covered[name + "map"].see(e.rows.columns[3 + k].values[row] - exact[k], U);
  double largest = 0.0;
  for (std::size_t n = 0; n < e.rows.columns[0].values.size(); ++n) {
    const Corner at = exact_node(t, e, n);
    largest = std::max(largest, std::hypot(at[0], at[1], at[2]));
  }
  if (const Value* v = value(e, "V_max"); v != nullptr && v->U)
    covered[name + "V_max"].see(v->value - largest, *v->U);
}

// 2,000 campaigns: NONIO_CAMPAIGNS=2000 test_rigid_body --gtest_filter=*WholeBudget*
TEST(Artefact, WholeBudgetCoversTheExactMachine) {
  const char* asked = std::getenv("NONIO_CAMPAIGNS");
  const int campaigns = asked != nullptr ? std::atoi(asked) : 16;
  const std::uint64_t seed = 20261126;
  std::mt19937_64 random(seed);
  const Scenario scenarios[] = {
      {"scatter", 0.5 * um, 0.2 * um, 0.2 * um, 0.001, false, false},
      {"certificate", 0.1 * um, 1.2 * um, 0.2 * um, 0.001, false, false},
      {"scale", 0.2 * um, 0.2 * um, 8 * um, 0.001, false, false},
      {"unknown balls, laser", 0.4 * um, 20 * um, 0.0, 0.001, true, false, false},
      {"all, laser and square", 0.4 * um, 0.8 * um, 1 * um, 0.001, true, true},
      {"all, laser and square turned over", 0.4 * um, 0.8 * um, 1 * um, 0.001, true, true, true,
       true}};
  std::map<std::string, Coverage> covered;
  for (int i = 0; i < campaigns; ++i)
    for (const Scenario& scenario : scenarios) {
      const Truth t = smooth_machine(random, 10, 15);
      see(scenario, t, done(campaign_of(scenario, t, random)), random, covered);
    }
  std::cout << "seed " << seed << ", " << campaigns << " campaigns of each\n";
  for (const auto& [name, c] : covered) {
    std::cout << name << ": " << c.percent() << " % of " << c.of << "\n";
    // Components of one campaign are no independent trials; what is refused is none.
    const double trials = std::min(static_cast<double>(campaigns), static_cast<double>(c.of));
    const double three = 300.0 * std::sqrt(0.95 * 0.05 / trials);
    EXPECT_NEAR(c.percent(), 95.0, std::max(1.5, three)) << name;
  }
}

}  // namespace
}  // namespace nonio::math::rigid_artefact_test
