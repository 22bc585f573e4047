// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/spindle.h"

#include <gtest/gtest.h>

#include "made_heat.h"

using namespace nonio;
using namespace heat;

namespace {

constexpr double turn_rad = 2.0 * std::numbers::pi;

/// One set-up: a sensor and what it reads over the angle.
void add_line(Made& t, const std::string& sensor, double ball, double at, int turns, int n,
              const std::function<double(double)>& r) {
  const auto line = static_cast<std::uint32_t>(t.o.lines.size());
  t.o.lines.push_back(
      {sensor + " ball " + std::to_string(ball) + " sensor " + std::to_string(at), {}});
  for (int i = 0; i < turns * n; ++i) {
    const double angle = turn_rad * i / n;
    t.o.axes[0].position.push_back(angle);
    t.o.axes[1].position.push_back(ball * turn_rad / 360.0);
    t.o.axes[2].position.push_back(at * turn_rad / 360.0);
    t.o.deviation.push_back(r(angle));
    t.o.line.push_back(line);
  }
}

Made empty() {
  Made t;
  begin(t, "spindle");
  t.o.axes = {{"S", true, {}, {}}, {"ball", true, {}, {}}, {"sensor", true, {}, {}}};
  return t;
}

double spindle_motion(double a) { return 1e-6 * std::cos(2.0 * a + 0.4); }
double ball_form(double a) { return 0.3e-6 * std::cos(3.0 * a + 0.7); }

}  // namespace

TEST(Spindle, UHoldsTheTruthOfBearings) {
  constexpr std::uint64_t seed = 20261125;
  SCOPED_TRACE("seed " + std::to_string(seed));
  for (const auto& [name, c] : spindle_coverage(60, seed)) {
    EXPECT_EQ(c.all, 60) << name;
    EXPECT_GE(c.within, 51) << name;
  }
}

TEST(Spindle, RotatingSensitiveDirectionDoesNotSeeTheSetUp) {
  Made t = empty();
  const auto e = [](double a) { return 5e-6 * std::cos(a + 0.3); };
  add_line(t, "X", 0, 0, 4, 64, [&](double a) { return e(a) + 2e-6; });
  add_line(t, "Y", 0, 0, 4, 64, [&](double a) { return e(a - turn_rad / 4.0) - 7e-6; });
  const auto out = evaluated(spindle(), t);
  ASSERT_NE(value(out, "total_R"), nullptr);
  EXPECT_NEAR(value(out, "total_R")->value, 0.0, 1e-12);
  EXPECT_EQ(finding(out, "spindle.fixed-only"), nullptr);
  // A tool that is pushed out twice a turn, as the work sees it.
  Made oval = empty();
  const auto r = [](double a) { return 1e-6 * std::cos(2.0 * a); };
  add_line(oval, "X", 0, 0, 4, 64, [&](double a) { return r(a) * std::cos(a); });
  add_line(oval, "Y", 0, 0, 4, 64, [&](double a) { return r(a) * std::sin(a); });
  EXPECT_NEAR(value(evaluated(spindle(), oval), "sync_R")->value, 2e-6, 1e-12);
}

TEST(Spindle, TheEccentricityShowsTheSenseOfRotation) {
  const auto made = [](double sense, double eccentricity) {
    Made t = empty();
    const auto r = [](double a) { return 1e-6 * std::cos(2.0 * a) + 0.4e-6 * std::cos(3.0 * a); };
    add_line(t, "X", 0, 0, 8, 64,
             [&](double a) { return eccentricity * std::cos(a + 0.3) + r(a) * std::cos(a); });
    add_line(t, "Y", 0, 0, 8, 64, [&](double a) {
      return sense * (eccentricity * std::sin(a + 0.3) + r(a) * std::sin(a));
    });
    return evaluated(spindle(), t);
  };
  const auto counter = made(1.0, 8e-6), clockwise = made(-1.0, 8e-6);
  EXPECT_NE(finding(counter, "spindle.sense-x-to-y"), nullptr);
  EXPECT_NE(finding(clockwise, "spindle.sense-y-to-x"), nullptr);
  for (const char* name : {"total_R", "sync_R", "async_R"})
    EXPECT_NEAR(value(clockwise, name)->value, value(counter, name)->value, 1e-12) << name;
  const Finding* unknown = finding(made(1.0, 0.2e-6), "spindle.sense-not-known");
  ASSERT_NE(unknown, nullptr);
  EXPECT_TRUE(unknown->attention);
}

TEST(Spindle, OneSensorIsAFixedSensitiveDirectionAndSaysSo) {
  Made t = empty();
  add_line(t, "X", 0, 0, 4, 64, spindle_motion);
  const auto out = evaluated(spindle(), t);
  EXPECT_NE(finding(out, "spindle.fixed-only"), nullptr);
  EXPECT_EQ(value(out, "total_R"), nullptr);
  const Finding* wave = finding(out, "spindle.wave");
  ASSERT_NE(wave, nullptr);
  EXPECT_EQ(evidence(*wave, "waves"), 2.0);
  EXPECT_NEAR(evidence(*wave, "amplitude"), 1e-6, 1e-9);
}

TEST(Spindle, ABallOfUnknownFormTakesUFromWhatHoldsIt) {
  Made t = empty();
  add_line(t, "X", 0, 0, 4, 64, spindle_motion);
  auto out = evaluated(spindle(), t);
  EXPECT_NE(finding(out, "spindle.ball-in-values"), nullptr);
  EXPECT_FALSE(value(out, "sync_X")->U);
  EXPECT_TRUE(value(out, "eccentricity_X") != nullptr && value(out, "async_X")->U);
  t.campaign.instrument.sphere = 0.05e-6;
  out = evaluated(spindle(), t);
  EXPECT_EQ(finding(out, "spindle.ball-in-values"), nullptr);
  ASSERT_TRUE(value(out, "sync_X")->U);
  EXPECT_GT(*value(out, "sync_X")->U, 0.05e-6);
}

TEST(Spindle, DonaldsonTakesTheBallOut) {
  Made t = empty();
  // The sensor on the other side reads the spindle with the other sign.
  add_line(t, "X", 0, 0, 4, 64, [](double a) { return spindle_motion(a) + ball_form(-a); });
  add_line(t, "X", 180, 180, 4, 64, [](double a) { return -spindle_motion(a) + ball_form(-a); });
  const auto out = evaluated(spindle(), t);
  EXPECT_NE(finding(out, "spindle.reversal"), nullptr);
  EXPECT_NEAR(value(out, "sync_X")->value, 2e-6, 0.01e-6);
  EXPECT_NEAR(value(out, "ball_X")->value, 0.6e-6, 0.01e-6);
  EXPECT_NEAR(value(out, "total_X")->value, 2e-6, 0.01e-6);
  EXPECT_EQ(finding(out, "spindle.ball-in-values"), nullptr);
  EXPECT_EQ(t.o.lines.size(), 2U);
  // Turned by 170 deg they are no reversal, and a finding says so.
  t.o.axes[1].position.back() = 170.0 * turn_rad / 360.0;
  for (std::size_t i = 0; i < t.o.size(); ++i)
    if (t.o.line[i] == 1) t.o.axes[1].position[i] = t.o.axes[1].position.back();
  const auto none = evaluated(spindle(), t);
  ASSERT_NE(finding(none, "spindle.set-ups-not-used"), nullptr);
  EXPECT_EQ(evidence(*finding(none, "spindle.set-ups-not-used"), "set_ups"), 2.0);
  EXPECT_FALSE(value(none, "total_X")->U);
}

// Both sensors with a reversal free the rotating sensitive direction of the ball too.
TEST(Spindle, ReversalsOfBothSensorsTakeTheBallOutOfBothDirections) {
  const auto with = [](double of_ball) {
    Made t = empty();
    const auto ball = [&](double a) { return of_ball * ball_form(-a); };
    for (const char* sensor : {"X", "Y"}) {
      const double phase = sensor[0] == 'X' ? 0.0 : turn_rad / 4.0;
      const auto S = [phase](double a) {
        return spindle_motion(a) * std::cos(phase) + 1e-5 * std::cos(a - phase);
      };
      add_line(t, sensor, 0, 0, 4, 64, [&](double a) { return S(a) + ball(a - phase); });
      add_line(t, sensor, 180, 180, 4, 64, [&](double a) { return -S(a) + ball(a - phase); });
    }
    return evaluated(spindle(), t);
  };
  const auto none = with(0.0), some = with(1.0);
  EXPECT_NEAR(value(some, "total_R")->value, value(none, "total_R")->value, 1e-9);
  EXPECT_TRUE(value(some, "sync_R")->U);
}

TEST(Spindle, MultiStepLeavesItsOwnWavesAndSaysSo) {
  for (const int waves : {3, 4}) {
    Made t = empty();
    for (int k = 0; k < 4; ++k)
      add_line(t, "X", 90 * k, 0, 4, 64, [&](double a) {
        return spindle_motion(a) + 0.3e-6 * std::cos(waves * (-a - k * turn_rad / 4.0));
      });
    const auto out = evaluated(spindle(), t);
    const Finding* f = finding(out, "spindle.multi-step-leaves");
    ASSERT_NE(f, nullptr);
    EXPECT_EQ(evidence(*f, "steps"), 4.0);
    const double clean = 2e-6;
    if (waves == 3) EXPECT_NEAR(value(out, "sync_X")->value, clean, 0.01e-6);
    if (waves == 4) EXPECT_GT(std::fabs(value(out, "sync_X")->value - clean), 0.03e-6);
    EXPECT_NEAR(value(out, "ball_X")->value, waves == 3 ? 0.6e-6 : 0.0, 0.01e-6);
  }
}

TEST(Spindle, TiltIsTheDifferenceOverTheDistance) {
  Made t = empty();
  add_line(t, "X1", 0, 0, 4, 64, [](double a) { return 1.5e-6 * std::cos(2.0 * a); });
  add_line(t, "X2", 0, 0, 4, 64, [](double a) { return 0.5e-6 * std::cos(2.0 * a); });
  EXPECT_NE(finding(evaluated(spindle(), t), "spindle.no-tilt"), nullptr);
  t.campaign.measurements[0].foot = 0.1;
  const auto out = evaluated(spindle(), t);
  ASSERT_NE(value(out, "sync_B"), nullptr);
  EXPECT_NEAR(value(out, "sync_B")->value, 20e-6, 1e-10);
}

TEST(Spindle, AlongTheAxisOnceATurnIsAnError) {
  Made t = empty();
  add_line(t, "Z", 0, 0, 4, 64,
           [](double a) { return 2e-6 * std::cos(a) + 0.5e-6 * std::cos(2.0 * a); });
  const auto out = evaluated(spindle(), t);
  EXPECT_NEAR(value(out, "fundamental_Z")->value, 4e-6, 1e-12);
  EXPECT_NEAR(value(out, "rest_Z")->value, 1e-6, 1e-12);
  EXPECT_GT(value(out, "total_Z")->value, 3.9e-6);
  EXPECT_EQ(value(out, "eccentricity_Z"), nullptr);
  EXPECT_TRUE(value(out, "sync_Z")->U) << "a ball's pole is its pole";
}

// Mistakes of other programs (reference): eccentricity taken off turn by turn eats the slow motion;
// the range of the asynchronous motion over all angles is larger than the largest at one angle.
TEST(Spindle, NoKnownMistakeOfOthers) {
  math::Turns k;
  k.n = 64, k.N = 8;
  for (std::size_t i = 0; i < k.n * k.N; ++i)
    k.r.push_back(1e-6 * std::cos(turn_rad * static_cast<double>(i) / 64.0 * 0.9));
  const auto e = math::error_motion(k);
  EXPECT_GT(e.asynchronous, 1.5e-6);
  EXPECT_LE(e.asynchronous, e.total + 1e-15);
  for (const double v : e.motion) EXPECT_TRUE(std::isfinite(v));
}

TEST(Spindle, ManyShiftsOfTheZeroAndTheAngleChangeNoValue) {
  constexpr std::uint64_t seed = 17;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random r(seed);
  const MadeTurns m = turning(r, 0.05e-6, 0.05e-6, 8, 64);
  const auto one = evaluated(spindle(), m.test);
  Made other = m.test;
  for (double& d : other.o.deviation) d += 3e-6;
  for (double& a : other.o.axes[0].position) a += 5.0 * turn_rad;
  const auto two = evaluated(spindle(), other);
  ASSERT_EQ(one.values.size(), two.values.size());
  for (std::size_t i = 0; i < one.values.size(); ++i)
    EXPECT_NEAR(one.values[i].value, two.values[i].value, 1e-11) << one.values[i].name;
}

TEST(Spindle, HostileReadingsAreNoCrashAndNoNumber) {
  Made t = empty();
  add_line(t, "X", 0, 0, 4, 64, [](double) { return 0.0; });
  for (const double d : {0.0, -1e20}) {
    t.o.deviation.assign(t.o.size(), d);
    const auto e = evaluated(spindle(), t);
    EXPECT_TRUE(e.values.empty());
    EXPECT_NE(finding(e, "sensor.refused-equal"), nullptr);
  }
  for (double& a : t.o.axes[0].position) a *= 1e18;
  EXPECT_TRUE(evaluated(spindle(), t).values.empty());
  EXPECT_NE(finding(evaluated(spindle(), t), "spindle.refused-turns"), nullptr);
  t.o = rearranged(t.o, {});
  EXPECT_TRUE(evaluated(spindle(), t).values.empty());
}
