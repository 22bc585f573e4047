// SPDX-License-Identifier: Apache-2.0
//
// What is left in the control's rotary axis: an exact machine, its refusals, before and after.
#include <gtest/gtest.h>

#include "machine.h"
#include "words.h"

namespace nonio::rtcp_test {
namespace {

const auto quiet = [] { return 0.0; };
const Vector ex = Vector::UnitX(), ez = Vector::UnitZ();

Machine wrong_by(double x, double y, double p, double q) {
  Machine m;
  m.true_centre += Vector(x, y, 0.0) * um;
  m.true_direction = Vector(p * urad, q * urad, 1.0).normalized();
  return m;
}

/// Two heights with a gauge along the radius, one along the axis, all turning with the table.
std::vector<Line> three(const Machine& m) {
  const Vector low = m.centre + Vector(0.15, 0.0, -0.05), high = low + 0.3 * ez;
  return {{low, ex, true, Vector(30, -20, 10) * um, 5 * um},
          {high, ex, true, Vector(-10, 40, 15) * um, -7 * um},
          {low, ez, true, Vector(30, -20, 10) * um, 2 * um}};
}

Evaluation evaluated(const Workshop& shop) {
  auto e = shop.last();
  EXPECT_TRUE(e);
  if (!e) return {};
  static const auto words = turntable::word_places("en");
  for (const Finding& f : e->findings) {
    if (f.id.starts_with("uncertainty.")) continue;
    const auto places = words.find(f.id);
    EXPECT_NE(places, words.end()) << f.id;
    if (places == words.end()) continue;
    for (const std::string& place : places->second) {
      bool has = false;
      for (const Number& n : f.evidence) has |= n.name == place;
      for (const auto& [name, text] : f.texts) has |= name == place;
      EXPECT_TRUE(has) << f.id << " " << place;
    }
  }
  return *e;
}

/// By hand: the axis is 10 um further along X than in the control. After half a turn the ball is at
/// -radius + 20 um and the tool at -radius: -20 um relative to the workpiece.
TEST(Rtcp, half_a_turn_shows_twice_the_error) {
  const Machine m = wrong_by(10, 0, 0, 0);
  EXPECT_NEAR(m.moved(m.centre + 0.1 * ex, Vector::Zero(), std::numbers::pi)[0], -20 * um, 1e-12);
  const auto o = gauges(m, {{m.centre + 0.1 * ex, ex, false}}, angles(8), quiet);
  const Evaluation e = evaluated(Workshop().with("ball_um", 1.0).with("sigma_um", 1.0).measured(o));
  ASSERT_NE(value(e, "centre_error_x"), nullptr);
  EXPECT_NEAR(value(e, "centre_error_x")->value, 10 * um, 1e-10);
  EXPECT_NEAR(value(e, "centre_error_y")->value, 0.0, 1e-10);
  EXPECT_NEAR(value(e, "span")->value, 20 * um, 1e-10);
}

TEST(Rtcp, exact_readings_give_centre_and_direction) {
  const Machine m = wrong_by(120, -80, 400, -250);
  const auto o = gauges(m, three(m), angles(12), quiet);
  const Evaluation e = evaluated(Workshop().with("sigma_um", 1.0).measured(o));
  // The centre holds at the mean height of the gauges across: 0.1 m above the control's point. Left
  // are products of two errors: 40 um of a ball's place and 400 urad make 16 nm.
  const double product = 20e-9;
  const double height = 0.1;
  for (const auto& [name, is] : {std::pair{"centre_error_x", 120 * um + height * 400 * urad},
                                 {"centre_error_y", -80 * um - height * 250 * urad}}) {
    ASSERT_NE(value(e, name), nullptr) << name;
    EXPECT_NEAR(value(e, name)->value, is, product) << name;
  }
  EXPECT_NEAR(value(e, "direction_error_i")->value, 400 * urad, product / 0.15);
  EXPECT_NEAR(value(e, "direction_error_j")->value, -250 * urad, product / 0.15);
  EXPECT_NEAR(value(e, "s")->value, 0.0, product);
  EXPECT_EQ(found(e, "rtcp.not-identifiable"), nullptr);
}

/// Places as a control shows them, to 0.001 mm, about an axis that leans: what drops out stays out.
TEST(Rtcp, rounded_places_tell_no_more_than_exact_ones) {
  Machine m = wrong_by(5, -5, 0, 0);
  m.direction = Vector(110 * urad, -60 * urad, 1.0).normalized();
  m.true_direction = Vector(130 * urad, -50 * urad, 1.0).normalized();
  auto o = gauges(m, three(m), angles(12), quiet);
  for (auto& axis : o.axes)
    if (!axis.rotary)
      for (double& x : axis.position) x = std::round(x / 1e-6) * 1e-6;
  const Evaluation e = evaluated(Workshop().with("sigma_um", 1.0).measured(o));
  ASSERT_NE(value(e, "direction_error_i"), nullptr);
  EXPECT_NEAR(value(e, "direction_error_i")->value, 20 * urad, 5 * urad);
  EXPECT_NEAR(value(e, "centre_error_x")->value, 5 * um + 0.1 * 20 * urad, 1 * um);
  EXPECT_LT(value(e, "s")->value, 0.5 * um);
  EXPECT_LE(value(e, "scatter_optimised")->value, value(e, "scatter_measured")->value);
}

TEST(Rtcp, a_head_is_seen_from_the_other_side) {
  Machine m = wrong_by(15, 25, 0, 0);
  m.head = true;
  const Vector tip = m.centre + Vector(0.2, 0.0, 0.0);
  const auto o = gauges(m, {{tip, ex, false}}, angles(12), quiet);
  const Evaluation e =
      evaluated(Workshop(true).with("ball_um", 1.0).with("sigma_um", 1.0).measured(o));
  ASSERT_NE(value(e, "centre_error_x"), nullptr);
  EXPECT_NEAR(value(e, "centre_error_x")->value, 15 * um, 1e-10);
  EXPECT_NEAR(value(e, "centre_error_y")->value, 25 * um, 1e-10);
  Workshop wrong(false);  // the same readings as those of a table have the other sign
  const Evaluation other = evaluated(
      wrong.with("ball_um", 1.0).with("sigma_um", 1.0).with("tolerance_um", 1e4).measured(o));
  ASSERT_NE(value(other, "centre_error_x"), nullptr);
  EXPECT_NEAR(value(other, "centre_error_x")->value, -15 * um, 1e-9);
}

TEST(Rtcp, what_a_direction_cannot_tell_is_refused_by_name) {
  const Machine m = wrong_by(10, 20, 30, 40);
  const Vector ball = m.centre + 0.1 * ex;
  const auto told = [&](const Line& line) {
    const Evaluation e =
        evaluated(Workshop().with("sigma_um", 1.0).measured(gauges(m, {line}, angles(12), quiet)));
    std::string names;
    for (const Value& v : e.values)
      if (v.name.find("error") != std::string::npos) names += v.name + " ";
    for (const char* id : {"rtcp.not-identifiable", "rtcp.not-identifiable-ball"})
      if (const Finding* f = found(e, id))
        for (const auto& [key, text] : f->texts)
          if (key == "names") names += std::string("| ") + id + " " + text + " ";
    return names;
  };
  EXPECT_EQ(told({ball, ex}),
            "centre_error_x centre_error_y | rtcp.not-identifiable direction_error_i, "
            "direction_error_j ");
  EXPECT_EQ(told({ball, ez}),
            "direction_error_i direction_error_j | rtcp.not-identifiable "
            "centre_error_x, centre_error_y ");
  EXPECT_EQ(
      told({ball, ex, false}),
      "| rtcp.not-identifiable direction_error_i, direction_error_j | rtcp.not-identifiable-ball "
      "centre_error_x, centre_error_y ");
}

TEST(Rtcp, a_probe_tells_everything_from_one_ball) {
  const Machine m = wrong_by(50, -30, 200, 100);
  const Line ball{m.centre + Vector(0.15, 0.0, 0.08), ex, false, Vector(60, 20, -10) * um};
  const auto o = probe(m, {ball}, angles(8), Vector::Zero(), quiet);
  const Evaluation e = evaluated(Workshop().with("sigma_um", 1.0).measured(o));
  ASSERT_NE(value(e, "centre_error_x"), nullptr);
  EXPECT_NEAR(value(e, "centre_error_x")->value, 50 * um + 0.08 * 200 * urad, 2e-9);
  EXPECT_NEAR(value(e, "centre_error_y")->value, -30 * um + 0.08 * 100 * urad, 2e-9);
  ASSERT_NE(value(e, "direction_error_i"), nullptr);
  EXPECT_NEAR(value(e, "direction_error_i")->value, 200 * urad, 1e-8);
}

TEST(Rtcp, refusals_name_their_reason) {
  const Machine m = wrong_by(10, 0, 0, 0);
  const Vector ball = m.centre + 0.1 * ex;
  const auto refused = [](const Workshop& shop, const char* id) {
    const Evaluation e = evaluated(shop);
    EXPECT_NE(found(e, id), nullptr) << id;
    EXPECT_TRUE(e.values.empty()) << id;
  };
  const auto good = gauges(m, {{ball, ex}}, angles(8), quiet);
  refused(Workshop().with("tables", std::vector<std::string>{}).measured(good),
          "rtcp.carries-needed");
  refused(Workshop().with("heads", std::vector<std::string>{"C"}).measured(good),
          "rtcp.carries-needed");
  auto o = good;
  for (auto& axis : o.axes)
    if (!axis.rotary) std::fill(axis.position.begin(), axis.position.end(), 0.1);
  refused(Workshop().measured(o), "rtcp.none-go-round");
  o = good;
  o.axes[1].position[3] += 200 * um;
  refused(Workshop().measured(o), "rtcp.not-a-circle");
  o = gauges(m, {{ball, ex}, {ball + 0.2 * ez, ex}}, angles(8), quiet);
  for (std::size_t i = 8; i < 16; ++i) o.axes[1].position[i] += 100 * um;
  refused(Workshop().measured(o), "rtcp.places-disagree");
  refused(Workshop().measured(gauges(m, {{ball, ex}}, angles(4), quiet)), "rtcp.too-few");
}

TEST(Rtcp, a_short_arc_is_too_uncertain_for_the_tolerance) {
  const Machine m = wrong_by(10, 0, 0, 0);
  const auto o = gauges(m, {{m.centre + 0.1 * ex, ex}}, angles(12, 20 * deg), quiet);
  const Evaluation e = evaluated(Workshop().with("sigma_um", 2.0).measured(o));
  EXPECT_NE(found(e, "rtcp.too-uncertain"), nullptr);
  EXPECT_EQ(value(e, "centre_error_x"), nullptr);
}

TEST(Rtcp, before_and_after_say_what_the_new_parameters_did) {
  const auto answer = [](double left) {
    const Machine before = wrong_by(40, -30, 0, 0), after = wrong_by(40 * left, -30 * left, 0, 0);
    const Vector ball = before.centre + 0.1 * ex;
    Workshop shop;
    shop.stated(1 * um, 0.5 * um, 1.0).with("sigma_um", 1.0);
    shop.measured(gauges(before, {{ball, ex}}, angles(12), quiet), "before");
    shop.measured(gauges(after, {{ball, ex}}, angles(12), quiet), "after");
    const Evaluation e = evaluated(shop);
    EXPECT_EQ(e.uses, std::vector<std::string>{"Cbefore"});
    for (const char* id : {"rtcp.worked", "rtcp.not-active", "rtcp.wrong-sign",
                           "rtcp.something-else", "rtcp.cannot-tell"})
      if (found(e, id) != nullptr) return std::string(id);
    return std::string();
  };
  EXPECT_EQ(answer(0.0), "rtcp.worked");
  EXPECT_EQ(answer(1.0), "rtcp.not-active");
  EXPECT_EQ(answer(2.0), "rtcp.wrong-sign");
  EXPECT_EQ(answer(0.5), "rtcp.something-else");
}

}  // namespace
}  // namespace nonio::rtcp_test
