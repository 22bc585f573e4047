// SPDX-License-Identifier: Apache-2.0
// Circles: lines whose readings are sensed along the radius, at P = c + R n. With n = (cos t, sin
// t) in the plane and d = +1 counter-clockwise, -1 clockwise:
//     circle-centre    part of every model: a n_1 + b n_2, position of the instrument; a, b: m
//     servo-mismatch   XY, YZ, ZX: (F/F0) w d sin t cos t; w: m, path lag F0/Kv of the first axis
//                      less that of the second at F0 = 1000 mm/min: the lag is opposite to the
//                      motion, e = -F/Kv v; F/F0 = 1 where the feed F is not stated
//     lateral-play     EYX (e_y when X reverses) and so on: (L/2) n_y d_X, d_X direction of X; L: m
#include <algorithm>

#include "nonio/sdk/space_readings.h"

namespace nonio::circular_path {

namespace {

struct Plane {
  const char* name;
  std::size_t first, second;
};
constexpr Plane planes[] = {{"XY", 0, 1}, {"YZ", 1, 2}, {"ZX", 2, 0}};

std::vector<std::size_t> rows_of(const Observations& o, std::size_t line) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (o.line_of(i) == line) rows.push_back(i);
  return rows;
}

/// Null unless the readings of the line are on a circle and sensed along its radius.
const Plane* circle_plane(const Observations& o, const SpaceReadings& s, std::size_t line) {
  using V = SpaceLine::Vector;
  if (o.sense.empty() || o.angular || of_ball_centres(o)) return nullptr;
  const auto rows = rows_of(o, line);
  if (rows.size() < 8) return nullptr;
  const auto between = [](const V& a, const V& b) {
    return V{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  };
  const auto place = [&](std::size_t i) { return V{s.lever(0, i), s.lever(1, i), s.lever(2, i)}; };
  const std::size_t first = rows.front();
  std::size_t far = first;
  double widest = 0.0;
  for (const std::size_t i : rows) {
    const V off = between(o.sense_of(i), o.sense_of(first));
    if (const double size = SpaceLine::dot(off, off); size > widest) widest = size, far = i;
  }
  if (widest < 0.5) return nullptr;
  const V turn = between(o.sense_of(far), o.sense_of(first));
  const double R = SpaceLine::dot(between(place(far), place(first)), turn) / widest;
  if (!(R > 0.0)) return nullptr;
  for (const std::size_t i : rows) {
    const V way = between(place(i), place(first)), n = between(o.sense_of(i), o.sense_of(first));
    const V off{way[0] - R * n[0], way[1] - R * n[1], way[2] - R * n[2]};
    if (SpaceLine::dot(off, off) > 1e-6 * R * R) return nullptr;
  }
  for (const Plane& plane : planes) {
    const std::size_t third = 3 - plane.first - plane.second;
    if (std::all_of(rows.begin(), rows.end(),
                    [&](std::size_t i) { return std::fabs(o.sense_of(i)[third]) < 1e-6; }))
      return &plane;
  }
  return nullptr;
}

/// Direction of travel: +1 counter-clockwise, -1 clockwise, 0 not known.
int turn_of(const Observations& o, const Plane& plane, std::size_t i) {
  double turn = 0.0;
  for (const auto& axis : o.axes) {
    if (axis.rotary || i >= axis.approach.size()) continue;
    const std::size_t k = coordinate_of(axis.axis);
    if (k == plane.second) turn += o.sense_of(i)[plane.first] * axis.approach[i];
    if (k == plane.first) turn -= o.sense_of(i)[plane.second] * axis.approach[i];
  }
  return turn > 1e-9 ? 1 : turn < -1e-9 ? -1 : 0;
}

std::vector<std::string> circles(const Observations& o) {
  std::vector<std::string> names;
  if (o.sense.empty()) return names;
  const SpaceReadings s = space_of(o);
  for (std::size_t line = 0; line < o.lines.size(); ++line)
    if (circle_plane(o, s, line) != nullptr) names.push_back(o.lines[line].name);
  return names;
}

Expected<Effect::Columns> centre(const Observations& o, const Axis& place,
                                 const std::vector<double>&) {
  const SpaceReadings s = space_of(o);
  Effect::Columns out(2, std::vector<double>(o.size(), 0.0));
  for (std::size_t line = 0; line < o.lines.size(); ++line) {
    if (o.lines[line].name != place.name) continue;
    const Plane* plane = circle_plane(o, s, line);
    if (plane == nullptr) return fail("circle-centre: no circle " + place.name);
    for (const std::size_t i : rows_of(o, line)) {
      out[0][i] = o.sense_of(i)[plane->first];
      out[1][i] = o.sense_of(i)[plane->second];
    }
  }
  return out;
}

std::vector<std::string> mismatches(const Observations& o) {
  std::vector<std::string> names;
  if (o.sense.empty()) return names;
  const SpaceReadings s = space_of(o);
  for (const Plane& plane : planes)
    for (std::size_t line = 0; line < o.lines.size(); ++line) {
      if (circle_plane(o, s, line) != &plane) continue;
      const auto rows = rows_of(o, line);
      const auto turns = [&](std::size_t i) { return turn_of(o, plane, i) != 0; };
      if (std::none_of(rows.begin(), rows.end(), turns)) continue;
      names.emplace_back(plane.name);
      break;
    }
  return names;
}

constexpr double feed_of_lag = 1.0 / 60.0;  // m/s

Expected<Effect::Columns> mismatch(const Observations& o, const Axis& place,
                                   const std::vector<double>&) {
  const SpaceReadings s = space_of(o);
  Effect::Columns out(1, std::vector<double>(o.size(), 0.0));
  for (std::size_t line = 0; line < o.lines.size(); ++line) {
    const Plane* plane = circle_plane(o, s, line);
    if (plane == nullptr || place.name != plane->name) continue;
    const double feed = o.lines[line].feed.value_or(feed_of_lag) / feed_of_lag;
    for (const std::size_t i : rows_of(o, line))
      out[0][i] =
          feed * turn_of(o, *plane, i) * o.sense_of(i)[plane->first] * o.sense_of(i)[plane->second];
  }
  return out;
}

/// Axis `moved` shifts the other axis of its plane, `error`, by its direction of motion.
struct Play {
  const char* name;
  std::size_t error, moved;
};
constexpr Play plays[] = {{"EYX", 1, 0}, {"EXY", 0, 1}, {"EZX", 2, 0},
                          {"EXZ", 0, 2}, {"EZY", 2, 1}, {"EYZ", 1, 2}};

bool contains(const Plane& plane, const Play& play) {
  return (plane.first == play.error && plane.second == play.moved) ||
         (plane.first == play.moved && plane.second == play.error);
}

std::vector<std::string> plays_in(const Observations& o) {
  std::vector<std::string> names;
  if (o.sense.empty()) return names;
  const SpaceReadings s = space_of(o);
  for (const Play& play : plays)
    for (std::size_t line = 0; line < o.lines.size(); ++line)
      if (const Plane* plane = circle_plane(o, s, line);
          plane != nullptr && contains(*plane, play)) {
        names.emplace_back(play.name);
        break;
      }
  return names;
}

Expected<Effect::Columns> lateral_play(const Observations& o, const Axis& place,
                                       const std::vector<double>&) {
  const SpaceReadings s = space_of(o);
  Effect::Columns out(1, std::vector<double>(o.size(), 0.0));
  for (const Play& play : plays)
    for (std::size_t line = 0; line < o.lines.size() && place.name == play.name; ++line) {
      const Plane* plane = circle_plane(o, s, line);
      if (plane == nullptr || !contains(*plane, play)) continue;
      for (const auto& axis : o.axes)
        if (!axis.rotary && coordinate_of(axis.axis) == play.moved)
          for (const std::size_t i : rows_of(o, line))
            if (i < axis.approach.size())
              out[0][i] = 0.5 * axis.approach[i] * o.sense_of(i)[play.error];
    }
  return out;
}

}  // namespace

NONIO_PLUGIN(registry) {
  const auto always = [](const Observations&, const Axis&) { return true; };
  registry.add(Effect{
      .info = {"circle-centre", "1.0.0", "Position of the instrument of a circle: in every model"},
      .linear = {{"a", "shift along the first axis of the plane", Quantity::deviation},
                 {"b", "shift along the second", Quantity::deviation}},
      .shapes = {},
      .applies = always,
      .columns = centre,
      .instances = circles,
      .is_nuisance = true});
  registry.add(Effect{
      .info = {"servo-mismatch", "1.0.0", "Two axes that follow their command with different lag"},
      .linear = {{"w", "path lag at 1000 mm/min, first axis less second", Quantity::deviation}},
      .shapes = {},
      .applies = always,
      .columns = mismatch,
      .instances = mismatches});
  registry.add(Effect{
      .info = {"lateral-play", "1.0.0", "An axis that shifts another axis where it reverses"},
      .linear = {{"L", "shift by the reversal", Quantity::deviation}},
      .shapes = {},
      .applies = always,
      .columns = lateral_play,
      .instances = plays_in});
}

}  // namespace nonio::circular_path
