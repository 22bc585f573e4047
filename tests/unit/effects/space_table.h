// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "campaign/loader/plugins.h"
#include "machine.h"

/// Tables of lines in space, and what the exact machine reads on them.
namespace nonio::space {

using machine::Errors;
using Point = machine::Vector;
using Names = std::vector<std::string>;

inline constexpr double um = 1e-6, urad = 1e-6;
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline const Point corner(0.3, 0.2, 0.1), travel(0.8, 0.6, 0.5);

inline const std::vector<Effect>& effects() {
  static const loader::Plugins& plugins = []() -> const loader::Plugins& {
    static loader::Plugins loaded;
    loaded.load({NONIO_TEST_PLUGINS});
    return loaded;
  }();
  return plugins.effects();
}

inline const Effect& effect(const std::string& name) {
  for (const Effect& e : effects())
    if (e.info.name == name) return e;
  ADD_FAILURE() << "no effect " << name;
  static const Effect none;
  return none;
}

inline const Names space_kinds = {"squareness", "straightness", "yaw", "pitch", "roll"};
inline const Names set_up_kinds = {"line-slope", "mirror-tilt", "centre", "direction"};
inline const Names ball_kinds = {"radial-run-out", "axial-run-out", "linear-squareness",
                                 "linear-scale"};

enum class Optics {
  along,    ///< an interferometer along the line
  lateral,  ///< a straightedge or beam along the line
  mirror    ///< an interferometer and a flat mirror on the tool
};

struct Line {
  std::string name;
  std::vector<Point> stops;
  Point sense;
  Optics optics = Optics::along;

  /// Files of step diagonals have no reading of the start.
  std::size_t first() const { return optics == Optics::mirror ? 1 : 0; }
};

inline std::vector<double> readings(const Errors& e, const Line& line,
                                    const Eigen::Vector2d& tilt) {
  if (line.optics == Optics::along) return machine::interferometer(e, line.stops);
  if (line.optics == Optics::mirror) {
    auto out = machine::flat_mirror(e, line.stops, line.sense, tilt);
    out.erase(out.begin());
    return out;
  }
  std::vector<double> out;
  for (const Point& stop : line.stops)
    out.push_back(line.sense.dot(machine::point(e, stop) - stop));
  return out;
}

inline Observations table(const std::vector<Line>& lines, const std::string& structure = "gantry") {
  Observations o;
  o.structure = structure;
  for (const char letter : {'X', 'Y', 'Z'}) o.axes.push_back({{letter}, false, {}, {}});
  for (const Line& line : lines) {
    o.lines.push_back({line.name, {line.sense.x(), line.sense.y(), line.sense.z()}});
    for (std::size_t i = line.first(); i < line.stops.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        o.axes[k].position.push_back(line.stops[i][static_cast<Eigen::Index>(k)]);
      o.line.push_back(static_cast<std::uint32_t>(o.lines.size() - 1));
      o.deviation.push_back(0.0);
      o.run.push_back(1);
    }
  }
  for (auto& axis : o.axes) axis.approach.assign(o.size(), 1);
  return o;
}

/// From one point of the volume (0 to 1 each) to another in n steps.
inline Line straight(const std::string& name, const Point& from, const Point& to, int n = 20) {
  Line line{name, {}, {}};
  for (int i = 0; i <= n; ++i)
    line.stops.push_back(corner + (from + (to - from) * i / n).cwiseProduct(travel));
  line.sense = (line.stops.back() - line.stops.front()).normalized();
  return line;
}

inline Line sensed(Line line, const Point& across) {
  line.sense = across;
  line.optics = Optics::lateral;
  return line;
}

inline std::vector<Line> two_diagonals() {
  return {straight("D1", {0, 0, 0}, {1, 1, 0}), straight("D2", {0, 1, 0}, {1, 0, 0})};
}

inline std::vector<Line> upright_diagonals() {
  return {straight("XZ 1", {0, 0, 0}, {1, 0, 1}), straight("XZ 2", {0, 0, 1}, {1, 0, 0}),
          straight("YZ 1", {0, 0, 0}, {0, 1, 1}), straight("YZ 2", {0, 0, 1}, {0, 1, 0})};
}

/// X, then Y, then Z in each step.
inline std::vector<Line> step_diagonals(int n = 16) {
  std::vector<Line> lines;
  for (const auto& [name, sign] : std::vector<std::pair<std::string, Point>>{
           {"PPP", {1, 1, 1}}, {"NPP", {-1, 1, 1}}, {"PNP", {1, -1, 1}}, {"PPN", {1, 1, -1}}}) {
    Line line{name, {}, travel.cwiseProduct(sign).normalized(), Optics::mirror};
    Point moved(0, 0, 0);
    for (int step = 0; step <= 3 * n; ++step) {
      if (step > 0) moved[(step - 1) % 3] += 1.0 / n;
      const Point at = (Point(1, 1, 1) - sign) / 2.0 + moved.cwiseProduct(sign);
      line.stops.push_back(corner + at.cwiseProduct(travel));
    }
    lines.push_back(line);
  }
  return lines;
}

/// Both coordinates of the holes of a plate: one line each, as a machined part has them.
inline std::vector<Line> plate(int n = 6) {
  Line holes{"x", {}, {}};
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k)
      holes.stops.push_back(corner + Point(i, k, 0).cwiseProduct(travel) / n);
  Line y = holes;
  y.name = "y";
  return {sensed(holes, Point::UnitX()), sensed(y, Point::UnitY())};
}

inline std::vector<Line> axis_runs() {
  return {straight("X1", {0, 0, 0}, {1, 0, 0}), straight("X2", {0, 1, 0}, {1, 1, 0}),
          straight("Y", {0, 0, 0}, {0, 1, 0})};
}

inline std::vector<Line> all_straightness() {
  std::vector<Line> lines;
  for (int axis = 0; axis < 3; ++axis)
    for (int error = 0; error < 3; ++error)
      if (axis != error)
        lines.push_back(
            sensed(straight({'E', "XYZ"[error], "XYZ"[axis]}, Point::Zero(), Point::Unit(axis)),
                   Point::Unit(error)));
  return lines;
}

inline Axis named(const std::string& name) { return {.name = name}; }

}  // namespace nonio::space
