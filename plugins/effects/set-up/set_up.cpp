// SPDX-License-Identifier: Apache-2.0
// Unknowns of the set-up, in every model of readings that have them:
//     line-slope   of a line sensed across its travel (straightness): a q, the straightedge or beam
//                  was not parallel to the axis; q: way along the travel from its middle, m; a: rad
//     mirror-tilt  of a step diagonal: (a t1 + b t2) . P, the mirror was not square to the beam;
//                  t1, t2: unit vectors across the beam, P: commanded point, m; a, b: rad
#include <array>

#include "nonio/sdk/space_readings.h"

using namespace nonio;

namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector unit(Vector v) {
  const double size = std::sqrt(dot(v, v));
  for (double& x : v) x /= size;
  return v;
}

struct Line {
  std::vector<std::size_t> rows;
  std::vector<Vector> way;  // of each row from the first, m
  Vector sense{};
};

Line line_named(const Observations& o, const SpaceReadings& s, const std::string& name) {
  Line line;
  const auto point = [&](std::size_t i) {
    return Vector{s.lever(0, i), s.lever(1, i), s.lever(2, i)};
  };
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (o.lines[o.line.empty() ? 0 : o.line[i]].name != name) continue;
    Vector p = point(i);
    if (!line.rows.empty()) {
      const Vector first = point(line.rows.front());
      for (std::size_t k = 0; k < 3; ++k) p[k] -= first[k];
    } else {
      p = {};
    }
    line.rows.push_back(i);
    line.way.push_back(p);
  }
  if (!line.rows.empty()) line.sense = o.sense_of(line.rows.front());
  return line;
}

double farthest(const Line& line, Vector& way) {
  double most = 0.0;
  for (const Vector& w : line.way)
    if (dot(w, w) > most) most = dot(w, w), way = w;
  return std::sqrt(most);
}

/// Everything moves along one straight, and is sensed across it.
bool sensed_across(const Line& line) {
  Vector way{};
  const double length = farthest(line, way);
  if (!(length > 0.0)) return false;
  const Vector along = unit(way);
  for (const Vector& w : line.way) {
    const Vector off = cross(w, along);
    if (dot(off, off) > 1e-12 * length * length) return false;
  }
  return std::fabs(dot(along, line.sense)) < 1e-6;
}

/// It moves aside from the direction of sensing, and along it.
bool goes_in_steps(const Line& line) {
  Vector way{};
  const double length = farthest(line, way);
  if (!(length > 0.0) || std::fabs(dot(way, line.sense)) < 0.5 * length) return false;
  double most = 0.0;
  for (const Vector& w : line.way) {
    const Vector off = cross(w, line.sense);
    most = std::max(most, dot(off, off));
  }
  return most > 1e-12 * length * length;
}

std::vector<std::string> lines_that(const Observations& o, bool (*is)(const Line&)) {
  std::vector<std::string> names;
  if (o.angular || of_ball_centres(o)) return names;
  const SpaceReadings s = space_of(o);
  for (const auto& line : o.lines)
    if (is(line_named(o, s, line.name))) names.push_back(line.name);
  return names;
}

Expected<Effect::Columns> slope(const Observations& o, const Axis& place,
                                const std::vector<double>&) {
  const Line line = line_named(o, space_of(o), place.name);
  Vector way{};
  if (!(farthest(line, way) > 0.0)) return fail("line-slope: no line " + place.name);
  const Vector along = unit(way);
  Effect::Columns out(1, std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < line.rows.size(); ++i) out[0][line.rows[i]] = dot(line.way[i], along);
  return out;
}

Expected<Effect::Columns> tilt(const Observations& o, const Axis& place,
                               const std::vector<double>&) {
  const Line line = line_named(o, space_of(o), place.name);
  if (line.rows.empty()) return fail("mirror-tilt: no line " + place.name);
  const Vector up = std::fabs(line.sense[2]) < 0.9 ? Vector{0.0, 0.0, 1.0} : Vector{1.0, 0.0, 0.0};
  const Vector t1 = unit(cross(up, line.sense)), t2 = cross(line.sense, t1);
  Effect::Columns out(2, std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < line.rows.size(); ++i) {
    out[0][line.rows[i]] = dot(line.way[i], t1);
    out[1][line.rows[i]] = dot(line.way[i], t2);
  }
  return out;
}

}  // namespace

NONIO_PLUGIN(registry) {
  const auto always = [](const Observations&, const Axis&) { return true; };
  registry.add(Effect{
      .info = {"line-slope", "1.0.0", "How a straightness line stood to its axis: in every model"},
      .linear = {{"a", "angle between line and axis", Quantity::small_angle}},
      .shapes = {},
      .applies = always,
      .columns = slope,
      .of = [](const Observations& o) { return lines_that(o, sensed_across); },
      .always = true});
  registry.add(
      Effect{.info = {"mirror-tilt", "1.0.0",
                      "How the mirror of a step diagonal stood to its beam: in every model"},
             .linear = {{"a", "tilt of the mirror, level", Quantity::small_angle},
                        {"b", "tilt of the mirror, upright", Quantity::small_angle}},
             .shapes = {},
             .applies = always,
             .columns = tilt,
             .of = [](const Observations& o) { return lines_that(o, goes_in_steps); },
             .always = true});
}
