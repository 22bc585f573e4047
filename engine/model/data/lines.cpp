// SPDX-License-Identifier: Apache-2.0
#include "lines.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <string>

#include "design.h"
#include "nonio/sdk/observations.h"

namespace nonio::model {

namespace {

struct Order {
  std::vector<std::uint32_t> rows;  ///< row indices, first reading first
  bool known = true;                ///< if false, nothing may be concluded from the order in time
  bool assumed = false;  ///< whether the cycle of ISO 230-2 replaces an impossible order of rows
};

using Rows = std::vector<std::uint32_t>;

/// Rows of each pass (run and direction), in the order of the file.
using Passes = std::map<std::pair<std::uint32_t, std::int8_t>, Rows>;

Passes passes_of(const Observations& o) {
  Passes passes;
  for (std::uint32_t i = 0; i < o.size(); ++i)
    passes[{o.run_of(i), o.axes.front().approach[i]}].push_back(i);
  return passes;
}

/// Whether there are several runs, with all readings of one direction before all readings of the
/// other.
bool grouped(const Passes& passes) {
  std::map<std::int8_t, Rows> side;
  std::map<std::int8_t, int> runs;
  for (const auto& [pass, rows] : passes) {
    auto& all = side[pass.second];
    all.insert(all.end(), rows.begin(), rows.end());
    ++runs[pass.second];
  }
  if (side.size() != 2 || runs.begin()->second < 2) return false;
  const auto ends = [](const Rows& rows) { return std::minmax_element(rows.begin(), rows.end()); };
  const auto [low, high] = ends(side.begin()->second);
  const auto [other_low, other_high] = ends(side.rbegin()->second);
  return *high < *other_low || *other_high < *low;
}

/// Returns whether some pass of at least three readings is listed from its end to its start.
bool against_its_direction(const Observations& o, const Passes& passes) {
  const auto& position = o.axes.front().position;
  return std::any_of(passes.begin(), passes.end(), [&](const auto& entry) {
    const auto& [pass, rows] = entry;
    if (pass.second == 0 || rows.size() < 3) return false;
    for (std::size_t k = 1; k < rows.size(); ++k)
      if (!((position[rows[k]] - position[rows[k - 1]]) * pass.second < 0.0)) return false;
    return true;
  });
}

/// Run by run, starting with the direction that is listed first, each pass along its direction.
/// Runs are counted separately in each direction, because a file may continue their numbering.
Rows pendulum(const Observations& o, const Passes& passes) {
  const auto& axis = o.axes.front();
  std::map<std::int8_t, std::uint32_t> count;
  std::map<std::pair<std::uint32_t, std::int8_t>, std::uint32_t> turn;
  for (const auto& [pass, rows] : passes) turn[pass] = count[pass.second]++;
  const std::int8_t first = axis.approach.front();
  Rows rows(o.size());
  std::iota(rows.begin(), rows.end(), 0U);
  std::stable_sort(rows.begin(), rows.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::int8_t way = axis.approach[a], other = axis.approach[b];
    const std::uint32_t of_a = turn.at({o.run_of(a), way}), of_b = turn.at({o.run_of(b), other});
    if (of_a != of_b) return of_a < of_b;
    if (way != other) return way == first;
    return axis.position[a] * way < axis.position[b] * way;
  });
  return rows;
}

/// Order in time, if every reading has a time. Otherwise `said`, from the manifest: "pendulum",
/// "as-listed" or "unknown" (as listed, and not known). If `said` is empty, as listed, unless a
/// machine cannot have moved in this order: several runs with all readings of one direction before
/// all of the other, or a pass against its direction. Then the cycle of ISO 230-2 is assumed.
Order order_of(const Observations& o, const std::string& said) {
  Order out;
  out.rows.resize(o.size());
  std::iota(out.rows.begin(), out.rows.end(), 0U);
  if (o.size() == 0) return out;
  if (o.time.size() == o.size() &&
      std::all_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); })) {
    std::stable_sort(out.rows.begin(), out.rows.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return o.time[a] < o.time[b]; });
    return out;
  }
  out.known = said != "unknown";
  if (said == "as-listed" || !out.known) return out;
  const Passes passes = passes_of(o);
  out.assumed = said.empty() && (grouped(passes) || against_its_direction(o, passes));
  if (out.assumed || said == "pendulum") out.rows = pendulum(o, passes);
  return out;
}

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
constexpr double no_share = 1e-9;  // smallest significant component of a unit vector

int components(const Vector& sense) {
  return static_cast<int>(
      std::count_if(sense.begin(), sense.end(), [](double x) { return std::fabs(x) > no_share; }));
}

bool moves(const Observations::AxisColumn& axis) {
  const auto [low, high] = std::minmax_element(axis.position.begin(), axis.position.end());
  return *low < *high;
}

/// Appends the measured columns of `more`, but not positions and lines.
void append_readings(Part& part, const Observations& more, const std::string& id) {
  Observations& to = part.table;
  const std::size_t before = to.size(), added = more.size();
  part.measurement.insert(part.measurement.end(), added,
                          static_cast<std::uint32_t>(part.measurements.size()));
  part.measurements.push_back(id);
  part.row.resize(before + added);
  std::iota(part.row.begin() + static_cast<std::ptrdiff_t>(before), part.row.end(), 0U);
  append_measured(to, more);
  to.missing += more.missing;
}

/// An axis that is not in the readings has the position that the manifest states, otherwise NaN.
Observations::AxisColumn column_of(const std::string& axis, const Observations& o,
                                   const Measurement& m) {
  if (const auto* column = o.axis(axis)) {
    Observations::AxisColumn out = *column;
    out.approach.resize(o.size(), 0);
    return out;
  }
  double stood = not_known;
  for (const auto* places : {&m.at, &m.from})
    if (const auto place = places->find(axis); place != places->end()) stood = place->second;
  return {axis, false, std::vector<double>(o.size(), stood), std::vector<std::int8_t>(o.size(), 0)};
}

Vector point_of(const Observations& o, std::size_t i) {
  Vector p{};
  for (const auto& axis : o.axes)
    if (const std::size_t k = coordinate_of(axis.axis); !axis.rotary && k < 3)
      p[k] = axis.position[i];
  return p;
}

/// Arc length from the point at 0 deg, counterclockwise; direction +1 for counterclockwise.
void append_angles(Part& part, const Observations& o, const Measurement& m) {
  double radius = 0.0;
  std::size_t u = 0, v = 1;
  for (const auto& [axis, from] : m.from)
    if (const auto to = m.to.find(axis); to != m.to.end() && to->second != from)
      radius = to->second - from, u = coordinate_of(axis);
    else
      v = coordinate_of(axis);
  const auto approach = [&](std::size_t k, std::size_t i) {
    for (const auto& axis : o.axes)
      if (coordinate_of(axis.axis) == k && i < axis.approach.size())
        return static_cast<double>(axis.approach[i]);
    return 0.0;
  };
  for (std::size_t i = 0; i < o.size(); ++i) {
    const Vector& n = o.sense_of(i);
    const double angle = std::atan2(n[v], n[u]);
    part.along.push_back(radius * (angle < 0.0 ? angle + 2.0 * std::numbers::pi : angle));
    part.way.push_back(n[u] * approach(v, i) - n[v] * approach(u, i) > 0.0 ? std::int8_t{1}
                                                                           : std::int8_t{-1});
  }
}

/// If exactly one linear axis moves, place and direction are its position and approach; for a
/// circle see `append_angles`; otherwise along the direction of sensing, from the start.
void append_places(Part& part, const Observations& o, const Measurement& m) {
  std::vector<const Observations::AxisColumn*> moved;
  for (const auto& axis : o.axes)
    if (!axis.rotary && coordinate_of(axis.axis) < 3 && moves(axis)) moved.push_back(&axis);
  Vector from{}, to{};
  for (const auto& [axis, at] : m.from)
    if (const std::size_t k = coordinate_of(axis); k < 3) from[k] = to[k] = at;
  for (const auto& [axis, at] : m.to)
    if (const std::size_t k = coordinate_of(axis); k < 3) to[k] = at;
  if (m.motion == Measurement::Motion::path) return append_angles(part, o, m);
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (moved.size() == 1) {
      part.along.push_back(moved.front()->position[i]);
      part.way.push_back(moved.front()->approach.empty() ? std::int8_t{0}
                                                         : moved.front()->approach[i]);
      continue;
    }
    const Vector& sense = o.sense_of(i);
    Vector p = point_of(o, i);
    // three of the four step diagonals do not start with all axes at `from`
    for (std::size_t k = 0; k < 3; ++k)
      p[k] -= (to[k] - from[k]) * sense[k] < 0.0 ? to[k] : from[k];
    part.along.push_back(dot(p, sense));
    double way = 0.0;
    for (const auto* axis : moved)
      if (!axis->approach.empty()) way += axis->approach[i] * sense[coordinate_of(axis->axis)];
    part.way.push_back(static_cast<std::int8_t>(way > no_share ? 1 : way < -no_share ? -1 : 0));
  }
}

void append_lines(Observations& to, const Observations& more, const Measurement& m) {
  const std::size_t before = to.line.size();
  const auto first = static_cast<std::uint32_t>(to.lines.size());
  for (Observations::Line line : more.lines) {
    // Two tables may both contain a line "1"; within a part, names of lines must be unique.
    if (std::any_of(to.lines.begin(), to.lines.end(),
                    [&](const auto& known) { return known.name == line.name; }))
      line.name = m.id + " " + line.name;
    line.feed = m.feed;
    to.lines.push_back(std::move(line));
  }
  for (std::size_t i = 0; i < more.size(); ++i) to.line.push_back(first + line_of(more, i));
  if (more.sense.empty() && to.sense.empty()) return;
  for (std::size_t i = to.sense.size(); i < before; ++i)
    to.sense.push_back(to.lines[to.line[i]].sense);
  for (std::size_t i = 0; i < more.size(); ++i) to.sense.push_back(more.sense_of(i));
}

/// Appends the channels of a measurement whose lines begin with `first`. Times of two measurements
/// have different origins, so each keeps its own channels.
void append_channels(Observations& to, const Observations& more, std::uint32_t first) {
  for (Observations::Channel channel : more.channels) {
    channel.lines.resize(to.lines.size() - first);
    std::iota(channel.lines.begin(), channel.lines.end(), first);
    to.channels.push_back(std::move(channel));
  }
}

}  // namespace

bool sensed_along_one_axis(const Observations& o) {
  if (o.axes.size() != 1 || o.axes.front().approach.size() != o.size()) return false;
  // for example, yaw is not a deviation along its linear axis
  if (o.angular) return o.axes.front().rotary;
  if (o.axes.front().rotary) return false;
  const std::size_t k = coordinate_of(o.axes.front().axis);
  for (std::size_t i = 0; i < o.size(); ++i) {
    const Vector& sense = o.sense_of(i);
    if (components(sense) > 0 && (k > 2 || !(sense[k] > 1.0 - no_share))) return false;
  }
  return true;
}

bool across(const Observations& o) {
  if (o.angular) return false;
  bool any = false;
  for (const auto& axis : o.axes) {
    if (!moves(axis)) continue;
    if (axis.rotary || coordinate_of(axis.axis) > 2) return false;
    any = true;
  }
  for (std::size_t i = 0; any && i < o.size(); ++i) any = components(o.sense_of(i)) > 0;
  return any;
}

bool senses_several(const Observations& o) {
  for (std::size_t i = 0; i < o.size(); ++i)
    if (components(o.sense_of(i)) > 1) return true;
  return false;
}

std::vector<std::size_t> coordinates_of(const Observations& o) {
  std::set<std::size_t> out;
  for (const auto& axis : o.axes)
    if (!axis.rotary && coordinate_of(axis.axis) < 3 && moves(axis))
      out.insert(coordinate_of(axis.axis));
  for (std::size_t i = 0; i < o.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (std::fabs(o.sense_of(i)[k]) > no_share) out.insert(k);
  return {out.begin(), out.end()};
}

void append_run(Part& part, const Observations& listed, const Measurement& m) {
  const Order order = order_of(listed, m.order);
  const bool as_listed = std::is_sorted(order.rows.begin(), order.rows.end());
  const Observations other = as_listed ? Observations{} : rearranged(listed, order.rows);
  const Observations& more = as_listed ? listed : other;
  if (order.assumed) part.order_assumed.push_back(m.id);
  Observations& to = part.table;
  to.order_known = to.order_known && order.known;
  const auto& from = more.axes.front();
  if (to.axes.empty()) {
    to.axes = {{from.axis, from.rotary, {}, {}}};
    to.angular = more.angular;
  }
  auto& axis = to.axes.front();
  const auto first = static_cast<std::uint32_t>(to.lines.size());
  axis.position.insert(axis.position.end(), from.position.begin(), from.position.end());
  axis.approach.insert(axis.approach.end(), from.approach.begin(), from.approach.end());
  part.along = axis.position;
  part.way = axis.approach;
  if (more.lines.size() > 1) {  // each line has a zero of its own
    append_lines(to, more, m);
  } else {
    to.line.insert(to.line.end(), more.size(), static_cast<std::uint32_t>(to.lines.size()));
    to.lines.push_back({m.id, more.lines.empty() ? Vector{} : more.lines.front().sense});
  }
  append_channels(to, more, first);
  append_readings(part, more, m.id);
  std::copy(order.rows.begin(), order.rows.end(),
            part.row.end() - static_cast<std::ptrdiff_t>(order.rows.size()));
}

void append_space(Part& part, const Campaign& campaign, const std::vector<Observations>& read,
                  const std::vector<std::size_t>& members) {
  Observations& to = part.table;
  to.structure = campaign.machine.structure;
  std::set<std::pair<std::size_t, std::string>> axes;  // sorted by coordinate
  const auto add = [&](const std::string& axis) {
    if (const std::size_t k = coordinate_of(axis); k < 3) axes.insert({k, axis});
  };
  for (const std::size_t m : members) {
    for (const auto& axis : read[m].axes)
      if (!axis.rotary) add(axis.axis);
    for (const auto& [axis, at] : campaign.measurements[m].at) add(axis);
  }
  for (const auto& [k, name] : axes) {
    const Axis* known = campaign.machine.axis(name);
    Axis axis;
    axis.name = name;
    part.axes.push_back(known == nullptr ? axis : *known);
    to.axes.push_back({name, false, {}, {}});
  }
  for (const std::size_t m : members) {
    const Observations& more = read[m];
    for (auto& axis : to.axes) {
      const auto column = column_of(axis.axis, more, campaign.measurements[m]);
      axis.position.insert(axis.position.end(), column.position.begin(), column.position.end());
      axis.approach.insert(axis.approach.end(), column.approach.begin(), column.approach.end());
    }
    to.order_known = to.order_known && more.order_known;
    const auto first = static_cast<std::uint32_t>(to.lines.size());
    append_lines(to, more, campaign.measurements[m]);
    append_channels(to, more, first);
    append_places(part, more, campaign.measurements[m]);
    append_readings(part, more, campaign.measurements[m].id);
  }
}

}  // namespace nonio::model
