// SPDX-License-Identifier: Apache-2.0
// Unknowns of the setup, which are part of every model of such readings:
// line-slope   of a line sensed across its travel (straightness): a q, the straightedge or beam
//              was not parallel to the axis; q: distance along the travel, m; a: rad
// mirror-tilt  of a step diagonal: (a t1 + b t2) . P, the mirror was not square to the beam;
//              t1, t2: unit vectors across the beam, P: commanded point, m; a, b: rad
// body-turn    of a part on the table: (w x P) . n; w: rotation about one axis, rad; n: direction
//              of sensing
// body-size    of a part of unknown temperature: a P . n; a: m/m
#include <algorithm>

#include "nonio/sdk/space_readings.h"

namespace nonio::set_up {

namespace {

using Vector = SpaceLine::Vector;

Vector unit(Vector v) {
  const double size = std::sqrt(SpaceLine::dot(v, v));
  for (double& x : v) x /= size;
  return v;
}

/// Whether the line is straight and sensed perpendicular to its direction.
bool sensed_across(const SpaceLine& line) {
  return line.straight && line.length > 0.0 &&
         std::fabs(SpaceLine::dot(line.farthest, line.sense)) < 1e-6 * line.length;
}

std::vector<std::string> lines_that(const Observations& o, bool (*is)(const SpaceLine&)) {
  std::vector<std::string> names;
  if (o.angular || of_ball_centres(o)) return names;
  const SpaceReadings s = space_of(o);
  for (std::size_t line = 0; line < o.lines.size(); ++line) {
    const SpaceLine way = space_line(o, s, line);
    // On a circle the direction of sensing varies.
    const bool one_sense = std::all_of(way.rows.begin(), way.rows.end(), [&](std::size_t i) {
      return SpaceLine::dot(o.sense_of(i), way.sense) > 1.0 - 1e-9;
    });
    if (one_sense && o.lines[line].body.empty() && is(way)) names.push_back(o.lines[line].name);
  }
  return names;
}

SpaceLine line_named(const Observations& o, const std::string& name) {
  for (std::size_t line = 0; line < o.lines.size(); ++line)
    if (o.lines[line].name == name) return space_line(o, space_of(o), line);
  return {};
}

Effect::Columns ways_along(const Observations& o, const SpaceLine& line,
                           const std::vector<Vector>& directions) {
  Effect::Columns out(directions.size(), std::vector<double>(o.size(), 0.0));
  for (std::size_t k = 0; k < directions.size(); ++k)
    for (std::size_t i = 0; i < line.rows.size(); ++i)
      out[k][line.rows[i]] = SpaceLine::dot(line.way[i], directions[k]);
  return out;
}

/// The largest component is positive, so that the result does not depend on the start of the line.
Vector upwards(Vector v) {
  const auto largest = std::max_element(
      v.begin(), v.end(), [](double a, double b) { return std::fabs(a) < std::fabs(b); });
  if (*largest < 0.0)
    for (double& x : v) x = -x;
  return v;
}

Expected<Effect::Columns> slope(const Observations& o, const Axis& place,
                                const std::vector<double>&) {
  const SpaceLine line = line_named(o, place.name);
  if (!(line.length > 0.0)) return fail("line-slope: no line " + place.name);
  return ways_along(o, line, {upwards(unit(line.farthest))});
}

Expected<Effect::Columns> tilt(const Observations& o, const Axis& place,
                               const std::vector<double>&) {
  const SpaceLine line = line_named(o, place.name);
  if (!(line.length > 0.0)) return fail("mirror-tilt: no line " + place.name);
  const Vector up = std::fabs(line.sense[2]) < 0.9 ? Vector{0.0, 0.0, 1.0} : Vector{1.0, 0.0, 0.0};
  const Vector level = unit(SpaceLine::cross(up, line.sense));
  return ways_along(o, line, {level, SpaceLine::cross(line.sense, level)});
}

/// A part and the axis of its rotation, named "<body> Z".
struct Turn {
  std::string body;
  std::size_t about = 0;
};
std::string name_of(const Turn& turn) { return turn.body + " " + "XYZ"[turn.about]; }

std::vector<std::string> bodies(const Observations& o, bool of_unknown_size) {
  std::vector<std::string> out;
  for (const auto& line : o.lines)
    if (!line.body.empty() && !(of_unknown_size && line.body_size_known) &&
        std::find(out.begin(), out.end(), line.body) == out.end())
      out.push_back(line.body);
  return out;
}

template <class Of>
std::vector<double> column_of(const Observations& o, const std::string& body, Of of) {
  const SpaceReadings s = space_of(o);
  std::vector<double> out(o.size(), 0.0);
  for (std::size_t i = 0; i < o.size(); ++i)
    if (!o.lines.empty() && o.lines[o.line_of(i)].body == body)
      out[i] = of(Vector{s.lever(0, i), s.lever(1, i), s.lever(2, i)}, o.sense_of(i));
  return out;
}

std::vector<double> column_of(const Observations& o, const Turn& turn) {
  Vector w{};
  w[turn.about] = 1.0;
  return column_of(o, turn.body, [&](const Vector& at, const Vector& sense) {
    return SpaceLine::dot(SpaceLine::cross(w, at), sense);
  });
}

/// Otherwise the zeros of the lines already contain the column.
bool varies_in_a_line(const Observations& o, const std::vector<double>& column) {
  std::vector<double> first(o.lines.size(), std::nan(""));
  for (std::size_t i = 0; i < column.size(); ++i) {
    double& known = first[o.line_of(i)];
    if (std::isnan(known)) known = column[i];
    if (column[i] != known) return true;
  }
  return false;
}

std::vector<std::string> turns(const Observations& o) {
  std::vector<std::string> out;
  for (const std::string& body : bodies(o, false))
    for (std::size_t about = 0; about < 3; ++about)
      if (const Turn turn{body, about}; varies_in_a_line(o, column_of(o, turn)))
        out.push_back(name_of(turn));
  return out;
}

Expected<Effect::Columns> turn(const Observations& o, const Axis& place,
                               const std::vector<double>&) {
  for (const std::string& body : bodies(o, false))
    for (std::size_t about = 0; about < 3; ++about)
      if (const Turn one{body, about}; name_of(one) == place.name)
        return Effect::Columns{column_of(o, one)};
  return fail("body-turn: no part " + place.name);
}

Expected<Effect::Columns> size(const Observations& o, const Axis& place,
                               const std::vector<double>&) {
  return Effect::Columns{column_of(o, place.name, [](const Vector& at, const Vector& sense) {
    return SpaceLine::dot(at, sense);
  })};
}

}  // namespace

NONIO_PLUGIN(registry) {
  const auto always = [](const Observations&, const Axis&) { return true; };
  registry.add(Effect{
      .info = {"line-slope", "1.0.0", "Angle of a straightness line to its axis: in every model"},
      .linear = {{"a", "angle between line and axis", Quantity::small_angle}},
      .shapes = {},
      .applies = always,
      .columns = slope,
      .instances = [](const Observations& o) { return lines_that(o, sensed_across); },
      .is_nuisance = true});
  registry.add(
      Effect{.info = {"mirror-tilt", "1.0.0",
                      "Angle of the mirror of a step diagonal to its beam: in every model"},
             .linear = {{"a", "tilt of the mirror, level", Quantity::small_angle},
                        {"b", "tilt of the mirror, upright", Quantity::small_angle}},
             .shapes = {},
             .applies = always,
             .columns = tilt,
             .instances =
                 [](const Observations& o) {
                   return lines_that(o, [](const SpaceLine& line) { return line.is_stepwise(); });
                 },
             .is_nuisance = true});
  registry.add(Effect{
      .info = {"body-turn", "1.0.0", "Turn of a part on the table: in every model of its features"},
      .linear = {{"a", "turn of the part", Quantity::small_angle}},
      .shapes = {},
      .applies = always,
      .columns = turn,
      .instances = turns,
      .is_nuisance = true});
  registry.add(Effect{
      .info = {"body-size", "1.0.0", "Size of a part of unknown temperature: in every model of it"},
      .linear = {{"a", "stretch of the part", Quantity::deviation_per_length}},
      .shapes = {},
      .applies = always,
      .columns = size,
      .instances = [](const Observations& o) { return bodies(o, true); },
      .is_nuisance = true});
}

}  // namespace nonio::set_up
