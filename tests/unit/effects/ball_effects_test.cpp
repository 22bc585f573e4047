// SPDX-License-Identifier: Apache-2.0
// Effects of ball centres, on the tables that the program makes of them.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <numbers>

#include "nonio/model/comparison.h"
#include "space_table.h"

namespace nonio::ball_effects_test {

namespace {

using namespace space;

constexpr double deg = std::numbers::pi / 180.0;

/// A table that turns about `axis` and carries a ball; the linear axes read its centre.
struct RotaryTable {
  std::string name = "C";
  Point axis = Point::UnitZ();
  Point centre{0.4, 0.3, 0.2};
  double radius = 0.25;
  int places = 16;
  double arc = 360.0;  ///< deg

  /// Where the axis is at an angle: its run-out, m.
  std::function<Point(double)> wander = [](double) { return Point::Zero(); };

  Point ball(double angle) const {
    const Point out = axis.unitOrthogonal() * radius;
    return centre + wander(angle) + Eigen::AngleAxisd(angle, axis) * out;
  }
};

/// The coordinates at which a machine with errors is at this point.
Point read_at(const machine::Errors& errors, const Point& point) {
  Point at = point;
  for (int step = 0; step < 5; ++step) at += point - machine::point(errors, at);
  return at;
}

model::Part measured(const RotaryTable& table, const machine::Errors& errors = {}) {
  Campaign campaign;
  campaign.machine.axes = {{.name = table.name, .rotary = true}};
  Measurement m;
  m.id = "ball";
  m.kind = "ball-centres";
  m.axis = table.name;
  campaign.measurements = {m};
  Observations o;
  o.measurement = m.id;
  o.axes = {
      {table.name, true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  o.lines = {{"x", {1, 0, 0}}, {"y", {0, 1, 0}}, {"z", {0, 0, 1}}};
  for (int place = 0; place < table.places; ++place) {
    const double angle = table.arc * deg * place / table.places;
    const Point at = read_at(errors, table.ball(angle));
    for (Eigen::Index k = 0; k < 3; ++k) {
      o.axes[0].position.push_back(angle);
      for (Eigen::Index c = 0; c < 3; ++c)
        o.axes[1 + static_cast<std::size_t>(c)].position.push_back(at[c]);
      o.deviation.push_back(at[k]);
      o.line.push_back(static_cast<std::uint32_t>(k));
      o.run.push_back(1);
    }
  }
  auto parts = model::parts_of(campaign, {o});
  EXPECT_EQ(parts.size(), 1u);
  return parts.empty() ? model::Part{} : parts.front();
}

/// What is left of the deviations after `value` times the columns and the best circle (centre,
/// direction, zeros of both lines), as a share of the largest that the circle does not take.
double left(const model::Part& part, const std::string& kind, const std::string& of,
            const std::vector<double>& value, const std::vector<double>& shape = {}) {
  const Observations& o = part.table;
  const auto n = static_cast<Eigen::Index>(o.size());
  Eigen::MatrixXd circle(n, 6);
  for (Eigen::Index i = 0; i < n; ++i) {
    circle(i, 0) = o.line[static_cast<std::size_t>(i)] == 0;
    circle(i, 1) = 1.0 - circle(i, 0);
  }
  Eigen::Index column = 2;
  for (const char* always : {"centre", "direction"}) {
    const auto columns = effect(always).columns(o, {.name = part.axes[0].name}, {});
    for (const auto& c : *columns)
      circle.col(column++) = Eigen::Map<const Eigen::VectorXd>(c.data(), n);
  }
  const auto beside = [&](const Eigen::VectorXd& y) -> Eigen::VectorXd {
    return y - circle * circle.colPivHouseholderQr().solve(y);
  };
  const Eigen::VectorXd there = beside(Eigen::Map<const Eigen::VectorXd>(o.deviation.data(), n));
  Eigen::VectorXd said = Eigen::VectorXd::Zero(n);
  const auto columns = effect(kind).columns(o, {.name = of}, shape);
  if (!columns || columns->size() != value.size()) return 1e9;
  for (std::size_t k = 0; k < value.size(); ++k)
    said += value[k] * Eigen::Map<const Eigen::VectorXd>((*columns)[k].data(), n);
  EXPECT_GT(there.lpNorm<Eigen::Infinity>(), 0.05 * um) << kind << " does not show";
  return (there - beside(said)).lpNorm<Eigen::Infinity>() / there.lpNorm<Eigen::Infinity>();
}

RotaryTable turning_about(const std::string& name) {
  RotaryTable t;
  t.name = name;
  t.axis = name == "A" ? Point::UnitX() : name == "B" ? Point::UnitY() : Point::UnitZ();
  return t;
}

}  // namespace

TEST(BallEffects, AreOfTheAxisAndOfWhatItsCircleCrosses) {
  for (const auto& [name, pair, axes] : std::vector<std::tuple<std::string, std::string, Names>>{
           {"A", "YZ", {"Y", "Z"}}, {"B", "XZ", {"X", "Z"}}, {"C", "XY", {"X", "Y"}}}) {
    const Observations o = measured(turning_about(name)).table;
    for (const char* kind : {"centre", "direction", "radial-run-out", "axial-run-out"})
      EXPECT_EQ(effect(kind).instances(o), Names{name}) << kind;
    EXPECT_EQ(effect("linear-squareness").instances(o), Names{pair});
    EXPECT_EQ(effect("linear-scale").instances(o), axes);
    for (const char* kind :
         {"squareness", "straightness", "yaw", "pitch", "roll", "line-slope", "mirror-tilt"})
      EXPECT_EQ(effect(kind).instances(o), Names{}) << kind;
  }
}

TEST(BallEffects, AGoodTableOnAGoodMachineReadsZero) {
  for (const double d : measured({}).table.deviation) EXPECT_NEAR(d, 0.0, 1e-12);
}

// The model moves the circle: the deviations of the table refer to a circle that is shifted by 3 um
// and -2 um and tilted by 4 and 5 urad.
TEST(BallEffects, CentreAndDirectionAreWhereTheCircleIs) {
  for (const std::string name : {"A", "B", "C"}) {
    const RotaryTable t = turning_about(name);
    Observations o = measured(t).table;
    const std::size_t first = name == "A" ? 1 : 0, second = name == "C" ? 1 : 2;
    Point shift = Point::Zero(), tilted = t.axis;
    shift[static_cast<Eigen::Index>(first)] = 3 * um;
    shift[static_cast<Eigen::Index>(second)] = -2 * um;
    tilted[static_cast<Eigen::Index>(first)] += 4 * urad;
    tilted[static_cast<Eigen::Index>(second)] += 5 * urad;
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(t.axis, tilted);
    const auto centre = effect("centre").columns(o, {.name = name}, {});
    const auto direction = effect("direction").columns(o, {.name = name}, {});
    ASSERT_TRUE(centre && direction);
    double zero = 0.0;
    for (std::size_t i = 0; i < o.size(); ++i) {
      const Point at = t.centre + shift + turn * (t.ball(o.axes[0].position[i]) - t.centre);
      const double exact =
          o.line[i] == 0 ? (at - t.centre).norm() - t.radius : (at - t.centre).dot(t.axis);
      double said = 3 * um * (*centre)[0][i] - 2 * um * (*centre)[1][i] +
                    4 * urad * (*direction)[0][i] + 5 * urad * (*direction)[1][i];
      if (o.line[i] == 1 && (i == 0 || o.line[i - 1] == 0)) zero = exact - said;
      EXPECT_NEAR(exact, said + (o.line[i] == 1 ? zero : 0.0), 1e-10) << name << " " << i;
    }
  }
}

TEST(BallEffects, SquarenessAndScaleAreThoseOfTheExactMachine) {
  machine::Errors e;
  e.C0Y = 4 * urad;
  EXPECT_LT(left(measured(turning_about("C"), e), "linear-squareness", "XY", {4 * urad}), 2e-3);
  e = {};
  e.B0Z = 4 * urad;
  EXPECT_LT(left(measured(turning_about("B"), e), "linear-squareness", "XZ", {4 * urad}), 2e-3);
  e = {};
  e.A0Z = 4 * urad;
  EXPECT_LT(left(measured(turning_about("A"), e), "linear-squareness", "YZ", {4 * urad}), 2e-3);
  for (const auto& [axis, error, turning] :
       std::vector<std::tuple<std::string, std::string, std::string>>{
           {"X", "EXX", "C"}, {"Y", "EYY", "C"}, {"Z", "EZZ", "B"}}) {
    e = {};
    e[error] = [](double x) { return 4 * urad * x; };
    const model::Part part = measured(turning_about(turning), e);
    EXPECT_LT(left(part, "linear-scale", axis, {4 * urad}), 2e-3) << axis;
  }
}

TEST(BallEffects, RunOutIsWhereTheAxisWanders) {
  RotaryTable t;
  t.wander = [](double a) { return Point(0, 0, 2 * um * std::cos(2 * a) - um * std::sin(3 * a)); };
  EXPECT_LT(left(measured(t), "axial-run-out", "C", {2 * um, 0.0, 0.0, -um}, {2.0}), 2e-3);
  // Away from the centre by r: where the ball is seen from there.
  t.wander = [&](double a) -> Point {
    const Point out = Eigen::AngleAxisd(a, t.axis) * t.axis.unitOrthogonal();
    return out * (2 * um * std::cos(2 * a) - um * std::sin(3 * a));
  };
  EXPECT_LT(left(measured(t), "radial-run-out", "C", {2 * um, 0.0, 0.0, -um}, {2.0}), 2e-3);
}

// The circle leaves n - 3 values, half of which may be used for waves.
TEST(BallEffects, WavesOfARunOutFollowFromTheAngles) {
  const auto waves = [](int places) {
    RotaryTable t;
    t.places = places;
    const model::Part part = measured(t);
    return effect("radial-run-out").shapes[0].grid(part.table, {.name = "C"});
  };
  using Grid = std::vector<double>;
  EXPECT_EQ(waves(4), Grid{});
  EXPECT_EQ(waves(7), Grid{1});
  EXPECT_EQ(waves(11), (Grid{1, 2}));
  EXPECT_EQ(waves(36), (Grid{1, 2, 3}));
}

}  // namespace nonio::ball_effects_test
