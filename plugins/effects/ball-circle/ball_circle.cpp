// SPDX-License-Identifier: Apache-2.0
// Circle of ball centers, which is part of every model of these readings. Line 1 contains the
// radial and line 2 the axial readings:
//     centre     n . e1, n . e2     (c1, c2: m)       n: direction of sensing
//     direction  axial rows: -P . e1, -P . e2   (d1, d2: rad)     P: position of the ball, m
// e1, e2: machine axes most nearly perpendicular to the rotary axis, in the order X, Y, Z (C: X, Y;
// B: X, Z; A: Y, Z). Radius and height are the zeros of the two lines. Values are corrections to
// the circle fitted to all centers.
#include "nonio/sdk/space_readings.h"

namespace nonio::ball_circle {

namespace {

/// Indices of the coordinates perpendicular to the rotary axis; empty without an axial reading.
std::vector<std::size_t> across(const Observations& o) {
  for (std::size_t i = 0; i < o.line.size(); ++i) {
    if (o.line_of(i) != 1) continue;
    std::size_t along = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::fabs(o.sense_of(i)[k]) > std::fabs(o.sense_of(i)[along])) along = k;
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < 3; ++k)
      if (k != along) out.push_back(k);
    return out;
  }
  return {};
}

std::vector<std::string> of(const Observations& o) {
  if (!of_ball_centres(o) || across(o).empty()) return {};
  return {o.axes.front().axis};
}

Expected<Effect::Columns> centre(const Observations& o, const Axis&, const std::vector<double>&) {
  const auto e = across(o);
  if (e.empty()) return fail("centre: expected centres of a ball");
  Effect::Columns out(2, std::vector<double>(o.size()));
  for (std::size_t i = 0; i < o.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k) out[k][i] = o.sense_of(i)[e[k]];
  return out;
}

Expected<Effect::Columns> direction(const Observations& o, const Axis&,
                                    const std::vector<double>&) {
  const auto e = across(o);
  if (e.empty()) return fail("direction: expected centres of a ball");
  const SpaceReadings s = space_of(o);
  Effect::Columns out(2, std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < o.size(); ++i)
    for (std::size_t k = 0; k < 2 && o.line_of(i) == 1; ++k) out[k][i] = -s.lever(e[k], i);
  return out;
}

}  // namespace

NONIO_PLUGIN(registry) {
  const auto always = [](const Observations&, const Axis&) { return true; };
  registry.add(
      Effect{.info = {"centre", "1.0.0", "Where the rotary axis is, from a ball: in every model"},
             .linear = {{"c1", "shift along the first machine axis across it", Quantity::deviation},
                        {"c2", "shift along the second", Quantity::deviation}},
             .shapes = {},
             .applies = always,
             .columns = centre,
             .instances = of,
             .is_nuisance = true});
  registry.add(Effect{
      .info = {"direction", "1.0.0", "Where the rotary axis points, from a ball: in every model"},
      .linear = {{"d1", "tilt towards the first machine axis across it", Quantity::small_angle},
                 {"d2", "tilt towards the second", Quantity::small_angle}},
      .shapes = {},
      .applies = always,
      .columns = direction,
      .instances = of,
      .is_nuisance = true});
}

}  // namespace nonio::ball_circle
