// SPDX-License-Identifier: Apache-2.0
// EYX: e_y = sum c_k s_k(x), and the five others; s_k: smooth basis of cubic splines without
// constant and slope over the positions where lines determine it (nonio/math/spline.h), rms 1; c_k:
// m. A slope is squareness, or the setup of the line.
#include <algorithm>
#include <cmath>
#include <limits>

#include "nonio/math/spline.h"
#include "nonio/sdk/space_readings.h"

namespace nonio::straightness {

namespace {

struct Name {
  std::size_t error = 3, axis = 3;  // coordinates 0 to 2; 3 if not set
};
Name read(const std::string& name) {
  if (name.size() != 3 || name[0] != 'E') return {};
  return {coordinate_of(name[1]), coordinate_of(name[2])};
}

std::vector<std::string> of(const Observations& o) {
  std::vector<std::string> names;
  if (of_ball_centres(o)) return names;
  const SpaceReadings s = space_of(o);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t error = 0; error < 3; ++error)
      if (axis != error && s.moves(axis) && varies_where_sensed(o, s, axis, error))
        names.push_back({'E', letter_of(error), letter_of(axis)});
  return names;
}

/// Keeps the position along the axis only on lines that move along it and sense the error. On other
/// lines the zero of the line includes the error, and a slope over their positions would be
/// confused with squareness.
SpaceReadings told(const Observations& o, const Name& name) {
  constexpr double least = 1e-9;  // smallest component of a unit vector that senses
  SpaceReadings s = space_of(o);
  std::vector<double>& at = s.r[name.axis];
  const auto senses = [&](std::size_t i) {
    return std::isfinite(at[i]) && std::fabs(o.sense_of(i)[name.error]) > least;
  };
  std::vector<double> low(std::max<std::size_t>(o.lines.size(), 1), INFINITY),
      high(low.size(), -INFINITY);
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!senses(i)) continue;
    low[o.line_of(i)] = std::min(low[o.line_of(i)], at[i]);
    high[o.line_of(i)] = std::max(high[o.line_of(i)], at[i]);
  }
  for (std::size_t i = 0; i < at.size(); ++i)
    if (!senses(i) || !(high[o.line_of(i)] - low[o.line_of(i)] > least))
      at[i] = std::numeric_limits<double>::quiet_NaN();
  return s;
}

std::vector<double> grid(const Observations& o, const Axis& place) {
  const Name name = read(place.name);
  if (name.axis > 2 || name.error > 2) return {};
  const std::vector<double> places = places_of(told(o, name), name.axis);
  constexpr std::size_t fewest_places = 6;
  return places.size() < fewest_places && !of_parts(o) ? std::vector<double>{} : knots_over(places);
}

Expected<Effect::Columns> columns(const Observations& o, const Axis& place,
                                  const std::vector<double>& shape) {
  const Name name = read(place.name);
  if (name.axis > 2 || name.error > 2)
    return fail("straightness: expected EYX, EZX, EXY, EZY, EXZ or EYZ, found " + place.name);
  if (shape.size() != 1 || !(shape[0] >= 2.0 && shape[0] <= 1000.0))
    return fail("straightness: expected a number of knots, 2 to 1000");
  const SpaceReadings s = told(o, name);
  auto out = math::smooth_basis(finite_or_zero(s.r[name.axis]), places_of(s, name.axis),
                                static_cast<int>(std::lround(shape[0])));
  if (!out) return fail("straightness: " + out.error().message);
  for (auto& column : *out)
    for (std::size_t i = 0; i < column.size(); ++i)
      column[i] *= std::isfinite(s.r[name.axis][i]) ? o.sense_of(i)[name.error] : 0.0;
  return out;
}

}  // namespace

NONIO_PLUGIN(registry) {
  const Effect straightness{
      .info = {"straightness", "1.0.0",
               "An axis that does not travel straight: a smooth error across its motion"},
      .linear = {{"s", "rms of the curve over the places", Quantity::deviation}},
      .shapes = {{{"knots", "knots of the spline", Quantity::count}, grid, false}},
      .curve = true,
      .compensable = true,
      .of_part = "part-straightness",
      .applies = [](const Observations& o, const Axis& a) { return !grid(o, a).empty(); },
      .columns = columns,
      .instances = of};
  registry.add(straightness);
  registry.add(in_frame_of_parts(
      straightness, {"part-straightness", "1.0.0",
                     "A bow that turns with the part: of fixture, clamping or measuring machine"}));
}

}  // namespace nonio::straightness
