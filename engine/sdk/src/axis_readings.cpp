// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/axis_readings.h"

#include <array>
#include <map>

#include "nonio/sdk/space_readings.h"

namespace nonio {

namespace {

bool complete(const std::vector<double>& column, const std::vector<char>& rows) {
  if (column.size() != rows.size()) return false;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] && !std::isfinite(column[i])) return false;
  return true;
}

/// Interpolates the temperatures of the rows `blank` of one line from the rows `known`. Returns
/// false if a gap is longer than a quarter of the line, if a row at an end of the line is more than
/// an eighth of the line from the nearest known row, or if fewer than three rows are known.
bool fill_blanks(const std::vector<std::uint32_t>& known, const std::vector<std::uint32_t>& blank,
                 AxisReadings& r) {
  if (blank.empty()) return true;
  if (known.size() < 3) return false;
  const auto& t = r.t;
  const double whole = std::max(t[known.back()], t[blank.back()]);
  for (const std::uint32_t i : blank) {
    const auto after = std::upper_bound(known.begin(), known.end(), t[i],
                                        [&](double at, std::uint32_t k) { return at < t[k]; });
    if (after == known.begin() || after == known.end()) {
      const std::uint32_t end = after == known.end() ? known.back() : known.front();
      if (std::fabs(t[i] - t[end]) > whole / 8.0) return false;
      r.K[i] = r.K[end];
    } else {
      const std::uint32_t a = *std::prev(after), b = *after;
      if (t[b] - t[a] > whole / 4.0) return false;
      r.K[i] = r.K[a] + (r.K[b] - r.K[a]) * (t[i] - t[a]) / (t[b] - t[a]);
    }
    r.interpolated.push_back(i);
  }
  return true;
}

bool known_temperatures(const Observations& o, AxisReadings& r) {
  if (o.material.size() != o.size()) return false;
  bool gaps = false;
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!r.moved[i]) continue;
    const bool has = std::isfinite(o.material[i]);
    if (has) r.K[i] = o.material[i];
    gaps = gaps || !has;
  }
  if (!gaps) return true;
  if (!(r.duration > 0.0)) return false;
  const std::size_t lines = std::max<std::size_t>(o.line.empty() ? 1 : o.lines.size(), 1);
  std::vector<std::vector<std::uint32_t>> known(lines), blank(lines);
  for (std::uint32_t i = 0; i < o.size(); ++i)
    if (r.moved[i])
      (std::isfinite(o.material[i]) ? known : blank)[o.line.empty() ? 0 : o.line[i]].push_back(i);
  const auto earlier = [&](std::uint32_t a, std::uint32_t b) { return r.t[a] < r.t[b]; };
  for (std::size_t line = 0; line < lines; ++line) {
    std::stable_sort(known[line].begin(), known[line].end(), earlier);
    std::stable_sort(blank[line].begin(), blank[line].end(), earlier);
    if (!fill_blanks(known[line], blank[line], r)) return false;
  }
  return true;
}

}  // namespace

namespace detail {

void fill_times(const Observations& o, AxisReadings& r) {
  r.timed = complete(o.time, r.moved);
  const auto line_of = [&](std::size_t i) { return o.line.empty() ? 0U : o.line[i]; };
  const std::size_t lines = std::max<std::size_t>(o.line.empty() ? 1 : o.lines.size(), 1);
  std::vector<double> of_line(lines, r.timed ? std::numeric_limits<double>::infinity() : 0.0);
  for (std::size_t i = 0; r.timed && i < o.size(); ++i)
    if (r.moved[i]) of_line[line_of(i)] = std::min(of_line[line_of(i)], o.time[i]);
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!r.moved[i]) continue;
    double& at = of_line[line_of(i)];
    r.t[i] = r.timed ? o.time[i] - at : o.order_known ? at++ : 0.0;
    r.duration = std::max(r.duration, r.t[i]);
  }
}

void fill_temperatures(const Observations& o, AxisReadings& r) {
  r.temperature = known_temperatures(o, r);
  if (!r.temperature) {
    std::fill(r.K.begin(), r.K.end(), 0.0);
    return r.interpolated.clear();
  }
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (r.moved[i]) sum += r.K[i], ++n;
  for (std::size_t i = 0; i < o.size(); ++i) r.K[i] = r.moved[i] ? r.K[i] - sum / n : 0.0;
}

}  // namespace detail

Expected<AxisReadings> readings_of(const Observations& o, const Axis& axis) {
  const Observations::AxisColumn* column = nullptr;
  for (const auto& c : o.axes)
    if (c.axis == axis.name && !c.approach.empty()) column = &c;
  if (column == nullptr)
    return fail("the readings do not state from where axis " + axis.name + " came");
  const std::size_t n = o.size();
  AxisReadings r;
  r.moved.assign(n, 0);
  for (auto* values : {&r.p, &r.theta, &r.d, &r.t, &r.K}) values->assign(n, 0.0);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < n; ++i) {
    if (column->approach[i] == 0) continue;
    r.moved[i] = 1;
    r.theta[i] = column->position[i];
    r.d[i] = column->approach[i];
    low = std::min(low, r.theta[i]);
    high = std::max(high, r.theta[i]);
  }
  if (!(low <= high)) return fail("the readings do not move axis " + axis.name);
  r.length = high - low;
  r.middle = (low + high) / 2.0;
  for (std::size_t i = 0; i < n; ++i)
    if (r.moved[i]) r.p[i] = r.theta[i] - r.middle;
  detail::fill_times(o, r);
  detail::fill_temperatures(o, r);
  return r;
}

bool from_both_directions(const AxisReadings& r) {
  return std::any_of(r.d.begin(), r.d.end(), [](double d) { return d > 0.0; }) &&
         std::any_of(r.d.begin(), r.d.end(), [](double d) { return d < 0.0; });
}

std::vector<double> fixed_points(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  if (!r) return {};
  if (axis.fixed_point && !axis.rotary) return {*axis.fixed_point - r->middle};
  if (axis.rotary || o.axes.size() > 1 || !(r->length > 0.0)) return {0.0};
  std::vector<double> points;
  for (const double at : {-1.5, -0.5, -0.2, 0.0, 0.2, 0.5, 1.5}) points.push_back(at * r->length);
  return points;
}

Effect::Shape fixed_point_shape() {
  return {.parameter = {"fixed", "fixed point, from the middle of the measured stretch",
                        Quantity::length, Quantity::angle},
          .grid = fixed_points,
          .usual = 0.0};
}

bool is_circle_without_times(const Observations& o) {
  if (o.sense.empty() || o.angular || of_ball_centres(o)) return false;
  if (std::any_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); }))
    return false;
  std::map<std::uint32_t, std::array<double, 3>> first;
  for (std::size_t i = 0; i < o.size(); ++i) {
    const std::uint32_t line = o.line_of(i);
    if (!o.lines[line].body.empty()) continue;
    const auto& n = first.try_emplace(line, o.sense[i]).first->second;
    if (n[0] * o.sense[i][0] + n[1] * o.sense[i][1] + n[2] * o.sense[i][2] < 0.5) return true;
  }
  return false;
}

WhyNot no_order(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  if (r && is_circle_without_times(o)) return {"no-times"};
  return {r && !(r->duration > 0.0) ? "no-order" : ""};
}

WhyNot one_direction(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return {r && !from_both_directions(*r) ? "one-direction" : ""};
}

std::vector<double> targets_of(const AxisReadings& r) {
  std::vector<double> targets;
  for (std::size_t i = 0; i < r.p.size(); ++i)
    if (r.moved[i] && std::isfinite(r.p[i])) targets.push_back(r.p[i]);
  std::sort(targets.begin(), targets.end());
  const double near = 1e-9 * r.length;
  targets.erase(std::unique(targets.begin(), targets.end(),
                            [near](double a, double b) { return b - a <= near; }),
                targets.end());
  return targets;
}

}  // namespace nonio
