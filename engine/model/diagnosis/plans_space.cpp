// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "data/lines.h"
#include "nonio/sdk/space_readings.h"
#include "plans.h"

namespace nonio::model {

namespace {

constexpr std::size_t most_stops = 21;
constexpr const char* planned = "plan";

/// Appends one line that passes all stops in order and then back.
void append_line(Observations& o, const std::string& name, const std::vector<Vector>& stops,
                 const Vector& sense) {
  if (!o.sense.empty()) o.sense.resize(o.size() + 2 * stops.size(), sense);
  const Vector& first = stops.front();
  const Vector& last = stops.back();
  for (const int side : {1, -1})
    for (std::size_t i = 0; i < stops.size(); ++i) {
      const Vector& stop = side > 0 ? stops[i] : stops[stops.size() - 1 - i];
      for (auto& axis : o.axes) {
        const std::size_t k = coordinate_of(axis.axis);
        const double way = (last[k] - first[k]) * side;
        axis.position.push_back(stop[k]);
        axis.approach.push_back(static_cast<std::int8_t>(way > 0.0 ? 1 : way < 0.0 ? -1 : 0));
      }
      o.deviation.push_back(0.0);
      o.line.push_back(static_cast<std::uint32_t>(o.lines.size()));
      o.run.push_back(1);
      if (!o.time.empty()) o.time.push_back(static_cast<double>(o.time.size()));
    }
  fill_measured(o);
  o.lines.push_back({name, sense});
}

/// The measured volume in commanded coordinates.
struct Volume {
  Vector low{}, high{};
  std::array<std::vector<double>, 3> places;  // selected positions of each axis
  bool has(std::size_t k) const { return places[k].size() >= 3; }
};

Volume volume_of(const Observations& o) {
  const SpaceReadings s = space_of(o);
  Volume v;
  for (const auto& axis : o.axes) {
    const std::size_t k = coordinate_of(axis.axis);
    double low = INFINITY;
    for (const double x : axis.position)
      if (std::isfinite(x)) low = std::min(low, x);
    if (k > 2 || !s.moves(k)) continue;
    const std::vector<double> all = nonio::places_of(s, k);
    const std::size_t stride = (all.size() + most_stops - 1) / most_stops;
    for (std::size_t i = 0; i < all.size(); i += stride) v.places[k].push_back(low + all[i]);
    v.low[k] = low, v.high[k] = low + s.length[k];
  }
  return v;
}

/// Returns the stops along one axis; the other coordinates are those of `at`.
std::vector<Vector> along(const Volume& v, std::size_t k, const Vector& at) {
  std::vector<Vector> stops;
  for (const double x : v.places[k]) {
    stops.push_back(at);
    stops.back()[k] = x;
  }
  return stops;
}

Vector unit_along(std::size_t k) {
  Vector v{};
  v[k] = 1.0;
  return v;
}

/// The angle between the straightedge or beam of a planned line and the axis `place`, as effect
/// line-slope of measured lines.
const Effect& slope_of_plan() {
  static const Effect slope{.info = {"line-slope", "1.0.0", ""},
                            .linear = {{"a", "", Quantity::small_angle}},
                            .shapes = {},
                            .applies = [](const Observations&, const Axis&) { return true; },
                            .columns = [](const Observations& o, const Axis& place,
                                          const std::vector<double>&) -> Expected<Effect::Columns> {
                              std::vector<double> column(o.size(), 0.0);
                              for (const auto& axis : o.axes)
                                if (axis.axis == place.name)
                                  for (std::size_t i = 0; i < o.size(); ++i)
                                    if (o.lines[o.line_of(i)].name == planned)
                                      column[i] = axis.position[i];
                              return Effect::Columns{std::move(column)};
                            },
                            .is_nuisance = true};
  return slope;
}

void add_straight_lines(const Part& part, const Volume& v, std::vector<Further>& out) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t error = 0; error < 3 && v.has(axis); ++error) {
      if (error == axis || !v.has(error)) continue;
      Further f{"straightness-line", {'E', letter_of(error), letter_of(axis)}, part.table};
      append_line(f.table, planned, along(v, axis, v.low), unit_along(error));
      Axis place;
      for (const auto& moved : part.table.axes)
        if (coordinate_of(moved.axis) == axis) place.name = moved.axis;
      f.set_up.push_back({&slope_of_plan(), std::move(place), {}});
      out.push_back(std::move(f));
    }
}

void add_other_lines(const Part& part, const Volume& v, std::vector<Further>& out) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t other = 0; other < 3 && v.has(axis); ++other) {
      if (other == axis || !v.has(other)) continue;
      Vector at = v.low;
      at[other] = v.high[other];
      Further f{"other-line", {letter_of(axis), letter_of(other)}, part.table};
      // Plan both ends, because a run without a stated position is taken to be at the corner.
      append_line(f.table, "plan 1", along(v, axis, v.low), unit_along(axis));
      append_line(f.table, "plan 2", along(v, axis, at), unit_along(axis));
      out.push_back(std::move(f));
    }
}

void add_diagonals(const Part& part, const Volume& v, std::vector<Further>& out) {
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = a + 1; b < 3; ++b) {
      if (!v.has(a) || !v.has(b)) continue;
      Vector way{};
      way[a] = v.high[a] - v.low[a];
      way[b] = (v.high[b] - v.low[b]) / 2.0;
      const double length = std::sqrt(dot(way, way));
      Vector sense = way;
      for (double& x : sense) x /= length;
      std::vector<Vector> stops;
      for (std::size_t i = 0; i < v.places[a].size(); ++i) {
        const double share = (v.places[a][i] - v.low[a]) / way[a];
        stops.push_back(v.low);
        for (std::size_t k = 0; k < 3; ++k) stops.back()[k] += share * way[k];
      }
      Further f{"half-diagonal", {letter_of(a), letter_of(b)}, part.table};
      append_line(f.table, planned, stops, sense);
      out.push_back(std::move(f));
    }
}

/// Appends a plan to measure the same ball at half the distance from the axis.
void add_smaller_circle(const Part& part, std::vector<Further>& out) {
  const Observations& o = part.table;
  Further f{"other-radius", "", o};
  Vector middle{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& p = o.axes[1 + k].position;
    const auto [low, high] = std::minmax_element(p.begin(), p.end());
    middle[k] = (*low + *high) / 2.0;
  }
  const auto lines = static_cast<std::uint32_t>(o.lines.size());
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!o.run.empty() && o.run[i] != o.run.front()) continue;
    f.table.axes[0].position.push_back(o.axes[0].position[i]);
    f.table.axes[0].approach.push_back(o.axes[0].approach[i]);
    for (std::size_t k = 0; k < 3; ++k)
      f.table.axes[1 + k].position.push_back((o.axes[1 + k].position[i] + middle[k]) / 2.0);
    f.table.sense.push_back(o.sense[i]);
    f.table.deviation.push_back(0.0);
    f.table.line.push_back(lines + o.line[i]);
    f.table.run.push_back(1);
    if (!o.time.empty()) f.table.time.push_back(o.time[i]);
  }
  fill_measured(f.table);
  for (const auto& line : o.lines)
    f.table.lines.push_back({line.name + " half radius", line.sense});
  out.push_back(std::move(f));
}

}  // namespace

std::vector<Further> further_in_space(const Part& part) {
  std::vector<Further> out;
  if (part.kind == Part::Kind::balls) {
    add_smaller_circle(part, out);
    return out;
  }
  const auto& lines = part.table.lines;
  if (std::any_of(lines.begin(), lines.end(), [](const auto& l) { return !l.body.empty(); }))
    return further_parts(part);
  const Volume v = volume_of(part.table);
  add_straight_lines(part, v, out);
  add_other_lines(part, v, out);
  add_diagonals(part, v, out);
  return out;
}

}  // namespace nonio::model
