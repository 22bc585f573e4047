// SPDX-License-Identifier: Apache-2.0
// The effects of several axes against a machine of exact transforms: what a small error changes in
// the readings is what the effect's columns say, but for the zeros of the lines.
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "nonio/math/spline.h"
#include "space_table.h"

namespace nonio::space_effects_test {

namespace {

using namespace space;

constexpr unsigned seed = 20261122;

/// The change of the readings by an error of the machine, each line less its mean.
std::vector<double> change(Errors e, const std::vector<Line>& lines) {
  e.y_ref = corner.y();
  e.z_ref = corner.z();
  std::vector<double> out;
  for (const Line& line : lines) {
    auto read = readings(e, line, {0.0, 0.0});
    const double mean =
        std::accumulate(read.begin(), read.end(), 0.0) / static_cast<double>(read.size());
    for (const double r : read) out.push_back(r - mean);
  }
  return out;
}

/// What the columns say, each line less its mean.
std::vector<double> said(const Effect::Columns& columns, const std::vector<double>& values,
                         const Observations& o) {
  std::vector<double> out(o.size(), 0.0), mean(o.lines.size(), 0.0), n(o.lines.size(), 0.0);
  for (std::size_t i = 0; i < o.size(); ++i) {
    for (std::size_t k = 0; k < columns.size(); ++k) out[i] += columns[k][i] * values[k];
    mean[o.line[i]] += out[i];
    ++n[o.line[i]];
  }
  for (std::size_t i = 0; i < o.size(); ++i) out[i] -= mean[o.line[i]] / n[o.line[i]];
  return out;
}

void expect_same(const std::vector<double>& exact, const std::vector<double>& columns,
                 const std::string& what) {
  ASSERT_EQ(exact.size(), columns.size()) << what;
  double largest = 0.0, off = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    largest = std::max(largest, std::fabs(exact[i]));
    off = std::max(off, std::fabs(exact[i] - columns[i]));
  }
  EXPECT_GT(largest, 0.05 * um) << what << ": these readings do not show it";
  EXPECT_LT(off, 2e-4 * largest) << what;
}

/// A smooth curve over an axis' places in the table by the basis of straightness and angles: the
/// straight line (of rms 1) if `line`, then `knots` functions.
struct Smooth {
  std::vector<double> places;
  std::vector<double> value;
  int knots;
  bool line;

  double operator()(double x) const { return at({x}).front(); }
  double integral_to(double x) const {  // Simpson, from the first place
    constexpr int n = 200;
    std::vector<double> steps;
    for (int i = 0; i <= n; ++i) steps.push_back(places.front() + (x - places.front()) * i / n);
    const auto values = at(steps);
    double sum = 0.0;
    for (int i = 0; i <= n; ++i)
      sum += (i == 0 || i == n ? 1.0
              : i % 2 == 1     ? 4.0
                               : 2.0) *
             values[static_cast<std::size_t>(i)];
    return sum * (x - places.front()) / (3.0 * n);
  }

 private:
  std::vector<double> at(const std::vector<double>& x) const {
    const auto basis = *math::smooth_basis(x, places, knots);
    std::vector<double> out(x.size(), 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (line) out[i] = value[0] * (x[i] - mean()) / spread();
      for (std::size_t k = 0; k < basis.size(); ++k) out[i] += value[k + line] * basis[k][i];
    }
    return out;
  }
  double mean() const {
    return std::accumulate(places.begin(), places.end(), 0.0) / static_cast<double>(places.size());
  }
  double spread() const {
    double sum = 0.0;
    for (const double p : places) sum += (p - mean()) * (p - mean());
    return std::sqrt(sum / static_cast<double>(places.size()));
  }
};

Smooth random_smooth(std::mt19937& rng, const Observations& o, std::size_t axis, double size,
                     bool line) {
  Smooth s;
  s.places = o.axes[axis].position;
  std::sort(s.places.begin(), s.places.end());
  s.places.erase(std::unique(s.places.begin(), s.places.end(),
                             [](double a, double b) { return b - a < 1e-9; }),
                 s.places.end());
  s.knots = 5;
  s.line = line;
  std::uniform_real_distribution<double> u(-size, size);
  for (int k = 0; k < s.knots + line; ++k) s.value.push_back(u(rng));
  return s;
}

Errors straightness_of(const std::string& name, const Smooth& s) {
  Errors e;
  e[name] = s;
  return e;
}

/// ISO letter of the angle of each kind about each axis' direction of travel.
std::string letters_of(const std::string& kind, const std::string& axis) {
  if (kind == "roll") return axis == "X" ? "EAX" : "EBY";
  if (kind == "pitch") return axis == "X" ? "EBX" : "EAY";
  return "EC" + axis;
}

struct Geometry {
  const char* name;
  std::vector<Line> lines;
  std::map<std::string, Names> of;  ///< of those kinds that are of anything
};

std::vector<Geometry> geometries() {
  auto both = two_diagonals();
  for (const Line& line : axis_runs()) both.push_back(line);
  const Line one = sensed(straight("L", {0, 0, 0}, {1, 0, 0}), {0, 1, 0});
  return {
      {"nothing", {}, {}},
      {"axis run", {axis_runs()[0]}, {}},
      {"X on two lines", {axis_runs()[0], axis_runs()[1]}, {{"yaw", {"X"}}}},
      {"straightness", {one}, {{"straightness", {"EYX"}}, {"line-slope", {"L"}}}},
      {"two diagonals",
       two_diagonals(),
       {{"squareness", {"XY"}}, {"straightness", {"EYX", "EXY"}}, {"yaw", {"X"}}}},
      {"one diagonal",
       {two_diagonals()[0]},
       {{"squareness", {"XY"}}, {"straightness", {"EYX", "EXY"}}, {"yaw", {"X"}}}},
      {"diagonals and axis runs",
       both,
       {{"squareness", {"XY"}}, {"straightness", {"EYX", "EXY"}}, {"yaw", {"X"}}}},
      {"diagonals of Y and Z",
       {straight("1", {0, 0, 0}, {0, 1, 1}), straight("2", {0, 1, 0}, {0, 0, 1})},
       {{"squareness", {"YZ"}}, {"straightness", {"EZY", "EYZ"}}, {"pitch", {"Y"}}}},
      {"diagonals of X and Z, of Y and Z",
       upright_diagonals(),
       {{"squareness", {"XZ", "YZ"}},
        {"straightness", {"EZX", "EZY", "EXZ", "EYZ"}},
        {"pitch", {"X", "Y"}}}},
      {"plate",
       plate(),
       {{"squareness", {"XY"}}, {"straightness", {"EYX", "EXY"}}, {"yaw", {"X"}}}},
      {"step diagonals",
       step_diagonals(),
       {{"squareness", {"XY", "XZ", "YZ"}},
        {"straightness", {"EYX", "EZX", "EXY", "EZY", "EXZ", "EYZ"}},
        {"yaw", {"X"}},
        {"pitch", {"X", "Y"}},
        {"roll", {"X", "Y"}},
        {"mirror-tilt", {"PPP", "NPP", "PNP", "PPN"}}}},
  };
}

}  // namespace

TEST(SpaceEffects, AreOfWhatTheReadingsCanShow) {
  for (const Geometry& g : geometries()) {
    const Observations o = table(g.lines);
    for (const auto* kinds : {&space_kinds, &set_up_kinds, &ball_kinds})
      for (const std::string& kind : *kinds) {
        const auto wanted = g.of.find(kind);
        EXPECT_EQ(effect(kind).instances(o), wanted == g.of.end() ? Names{} : wanted->second)
            << g.name << ", " << kind;
      }
  }
}

// There the carriage's way would only be another name for the straightness that is read.
TEST(SpaceEffects, AStraightnessLineOfASingleColumnIsNoYaw) {
  const auto of = [](const char* kind, const Line& line) {
    return effect(kind).instances(table({line}, "single-column"));
  };
  const Line level = sensed(straight("L", {0, 0, 0}, {1, 0, 0}), {0, 1, 0});
  const Line upright = sensed(straight("L", {0, 0, 0}, {1, 0, 0}), {0, 0, 1});
  for (const char* kind : {"yaw", "pitch"})
    for (const Line& line : {level, upright}) EXPECT_EQ(of(kind, line), Names{}) << kind;
}

TEST(SpaceEffects, OnlySetUpsAreAlwaysThere) {
  for (const auto& kind : set_up_kinds) EXPECT_TRUE(effect(kind).is_nuisance) << kind;
  for (const auto* kinds : {&space_kinds, &ball_kinds})
    for (const auto& kind : *kinds) EXPECT_FALSE(effect(kind).is_nuisance) << kind;
}

TEST(SpaceEffects, CrossTablesTakeSquarenessAndStraightnessAway) {
  for (const auto* kinds : {&space_kinds, &set_up_kinds, &ball_kinds})
    for (const auto& kind : *kinds)
      EXPECT_EQ(effect(kind).compensable, kind == "squareness" || kind == "straightness") << kind;
}

TEST(SpaceEffects, SquarenessIsThatOfTheExactMachine) {
  const std::vector<std::pair<std::string, double Errors::*>> all = {
      {"XY", &Errors::C0Y}, {"XZ", &Errors::B0Z}, {"YZ", &Errors::A0Z}};
  for (const auto& lines : {two_diagonals(), step_diagonals()}) {
    const Observations o = table(lines);
    const Names shown = effect("squareness").instances(o);
    for (const auto& [name, error] : all) {
      if (std::find(shown.begin(), shown.end(), name) == shown.end()) continue;
      Errors e;
      e.*error = 2.0 * urad;
      const auto columns = effect("squareness").columns(o, named(name), {});
      ASSERT_TRUE(columns) << columns.error().message;
      expect_same(change(e, lines), said(*columns, {2.0 * urad}, o), name);
    }
  }
}

// ISO 230-1: C0Y > 0 turns +Y towards -X, B0Z > 0 +Z towards +X, A0Z > 0 +Z towards -Y.
TEST(SpaceEffects, SignsOfSquareness) {
  const auto far = [](const char* name, const Point& to, const Point& sense) {
    Line line = sensed(straight("L", {0, 0, 0}, to), sense);
    line.stops[0].x() += 0.1;  // every coordinate moves
    line.stops[0].y() += 0.1;
    line.stops[0].z() += 0.1;
    return effect("squareness").columns(table({line}), named(name), {})->front().back();
  };
  EXPECT_LT(far("XY", {0, 1, 0}, {1, 0, 0}), 0.0);
  EXPECT_GT(far("XZ", {0, 0, 1}, {1, 0, 0}), 0.0);
  EXPECT_LT(far("YZ", {0, 0, 1}, {0, 1, 0}), 0.0);
}

TEST(SpaceEffects, StraightnessIsThatOfTheExactMachine) {
  std::cout << "seed " << seed << "\n";
  std::mt19937 rng(seed);
  for (const auto& lines : {two_diagonals(), step_diagonals(), all_straightness()}) {
    const Observations o = table(lines);
    for (const std::string& name : effect("straightness").instances(o)) {
      const auto s = random_smooth(rng, o, static_cast<std::size_t>(name[2] - 'X'), um, false);
      const auto columns = effect("straightness").columns(o, named(name), {5.0});
      ASSERT_TRUE(columns) << columns.error().message;
      ASSERT_EQ(columns->size(), 5u);
      expect_same(change(straightness_of(name, s), lines), said(*columns, s.value, o), name);
    }
  }
}

TEST(SpaceEffects, AnglesAreThoseOfTheExactMachine) {
  std::cout << "seed " << seed << "\n";
  std::mt19937 rng(seed);
  const std::vector<Line> across = {sensed(straight("high", {0, 0, 1}, {1, 0, 1}), {0, 1, 0}),
                                    sensed(straight("far", {0, 1, 0}, {1, 1, 0}), {0, 0, 1})};
  for (const auto& lines :
       {two_diagonals(), axis_runs(), upright_diagonals(), across, step_diagonals(), plate()}) {
    const Observations o = table(lines);
    for (const std::string kind : {"yaw", "pitch", "roll"})
      for (const std::string& axis : effect(kind).instances(o)) {
        const auto s = random_smooth(rng, o, static_cast<std::size_t>(axis[0] - 'X'), urad, true);
        const auto columns = effect(kind).columns(o, named(axis), {5.0});
        ASSERT_TRUE(columns) << columns.error().message;
        ASSERT_EQ(columns->size(), 6u);
        Errors e;
        e[letters_of(kind, axis)] = s;
        expect_same(change(e, lines), said(*columns, s.value, o),
                    kind + ":" + axis + " on " + lines.front().name);
      }
  }
}

TEST(SpaceEffects, OnASingleColumnTheWayIsTheIntegralOfTheAngle) {
  std::cout << "seed " << seed << "\n";
  std::mt19937 rng(seed);
  const std::vector<Line> upright = {straight("1", {0, 0, 0}, {1, 0, 1}),
                                     straight("2", {0, 0, 1}, {1, 0, 0})};
  const auto check = [&](const std::string& kind, const std::vector<Line>& lines,
                         const std::string& angle, const std::string& way, double sign) {
    const Observations o = table(lines, "single-column");
    const auto s = random_smooth(rng, o, 0, urad, true);
    Errors e;
    e[angle] = s;
    e[way] = [s, sign](double x) { return sign * s.integral_to(x); };
    const auto columns = effect(kind).columns(o, named("X"), {5.0});
    ASSERT_TRUE(columns) << columns.error().message;
    expect_same(change(e, lines), said(*columns, s.value, o), kind);
  };
  check("yaw", two_diagonals(), "ECX", "EYX", +1.0);
  check("yaw", plate(), "ECX", "EYX", +1.0);
  check("yaw", step_diagonals(), "ECX", "EYX", +1.0);
  check("pitch", upright, "EBX", "EZX", -1.0);
  check("pitch", step_diagonals(), "EBX", "EZX", -1.0);
  // The straight line alone: a parabola, -4F t(1 - t) for a bow of F.
  const Observations o = table(two_diagonals(), "single-column");
  const auto line = effect("yaw").columns(o, named("X"), {0.0});
  ASSERT_TRUE(line);
  EXPECT_EQ(line->size(), 1u);
}

TEST(SpaceEffects, WithoutTheStatedPositionOfAnAxisThereIsNoLever) {
  Observations o = table(two_diagonals());
  constexpr std::size_t x_unknown = 3, y_unknown = 25;
  o.axes[0].position[x_unknown] = nan;
  o.axes[1].position[y_unknown] = nan;
  o.axes[2].position.assign(o.size(), nan);
  const auto zero_only_at = [&](const char* kind, const char* of, std::vector<double> shape,
                                std::size_t row) {
    const auto columns = effect(kind).columns(o, named(of), shape);
    ASSERT_TRUE(columns) << columns.error().message;
    for (const auto& column : *columns) {
      EXPECT_EQ(column[row], 0.0) << kind << of;
      EXPECT_NE(column[row + 1], 0.0) << kind << of;
    }
  };
  zero_only_at("squareness", "XY", {}, y_unknown);
  zero_only_at("straightness", "EYX", {3.0}, x_unknown);
  zero_only_at("straightness", "EXY", {3.0}, y_unknown);
  zero_only_at("yaw", "X", {3.0}, x_unknown);
  zero_only_at("yaw", "X", {3.0}, y_unknown);
  EXPECT_EQ(effect("pitch").instances(o), Names{});
}

// Whichever end a line was begun at.
TEST(SpaceEffects, ALineSlopesAlongItsAxis) {
  for (const bool back : {false, true}) {
    Line line = sensed(straight("L", {0, 0, 0}, {1, 0, 0}), {0, 1, 0});
    if (back) std::reverse(line.stops.begin(), line.stops.end());
    Errors e;
    e.EYX = [](double x) { return 3.0 * urad * x; };
    const Observations o = table({line, straight("X", {0, 0, 0}, {1, 0, 0})});
    const auto columns = effect("line-slope").columns(o, named("L"), {});
    ASSERT_TRUE(columns) << columns.error().message;
    auto exact = change(e, {line});
    exact.resize(o.size(), 0.0);  // nothing on other lines
    expect_same(exact, said(*columns, {3.0 * urad}, o), back ? "back" : "there");
  }
}

TEST(SpaceEffects, AMirrorAskewIsTwoColumnsOfItsLine) {
  const std::vector<Line> lines = step_diagonals();
  const Observations o = table(lines);
  for (const Line& line : lines) {
    const auto columns = effect("mirror-tilt").columns(o, named(line.name), {});
    ASSERT_TRUE(columns) << columns.error().message;
    ASSERT_EQ(columns->size(), 2u);
    const auto exact = readings({}, line, {2 * urad, -3 * urad});
    Eigen::MatrixXd A(static_cast<Eigen::Index>(exact.size()), 3);
    Eigen::VectorXd b(A.rows());
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < o.size(); ++i) {
      if (o.lines[o.line[i]].name == line.name) {
        A.row(row) << (*columns)[0][i], (*columns)[1][i], 1.0;
        b(row) = exact[static_cast<std::size_t>(row)];
        ++row;
      } else {
        EXPECT_EQ((*columns)[0][i], 0.0);
        EXPECT_EQ((*columns)[1][i], 0.0);
      }
    }
    const Eigen::VectorXd x = A.colPivHouseholderQr().solve(b);
    EXPECT_LT((A * x - b).lpNorm<Eigen::Infinity>(), 1e-4 * b.lpNorm<Eigen::Infinity>());
    EXPECT_NEAR(std::hypot(x(0), x(1)), std::hypot(2 * urad, 3 * urad), 1e-9);
  }
}

// Directions of four digits and positions of a micrometre, as files have them.
TEST(SpaceEffects, ARoundedDiagonalDoesNotGoInSteps) {
  auto lines = two_diagonals();
  for (Line& line : lines) {
    for (Point& stop : line.stops) stop = (stop * 1e6).array().round() * 1e-6;
    line.sense = (line.sense * 1e3).array().round() * 1e-3;
  }
  EXPECT_EQ(effect("mirror-tilt").instances(table(lines)), Names{});
}

}  // namespace nonio::space_effects_test
