// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"

namespace nonio {

/// What the columns of an effect on one axis are made of; each of length observations.size(), 0 in
/// rows in which the axis did not move.
struct AxisReadings {
  std::vector<char> moved;
  std::vector<double> p;      ///< position from the middle of the measured stretch, m or rad
  std::vector<double> theta;  ///< position as commanded, m or rad
  std::vector<double> d;      ///< direction of approach: +1, -1
  std::vector<double> t;      ///< since the first reading of its line, s
  std::vector<double> K;  ///< material temperature less its mean, K; 0 everywhere if not measured
  double length = 0.0;    ///< of the measured stretch
  double duration = 0.0;  ///< of the longest line, s
  /// False: one reading counts as one second, in the order of the rows; where that is not known
  /// either, `t` is 0 everywhere.
  bool timed = false;
  bool temperature = false;  ///< every reading has a material temperature
};

namespace detail {

inline bool complete(const std::vector<double>& column, const std::vector<char>& rows) {
  if (column.size() != rows.size()) return false;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] && !std::isfinite(column[i])) return false;
  return true;
}

inline void fill_times(const Observations& o, AxisReadings& r) {
  r.timed = complete(o.time, r.moved);
  const auto line_of = [&](std::size_t i) { return o.line.empty() ? 0U : o.line[i]; };
  const std::size_t lines = std::max<std::size_t>(o.line.empty() ? 1 : o.lines.size(), 1);
  std::vector<double> first(lines, std::numeric_limits<double>::infinity()), count(lines, 0.0);
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!r.moved[i]) continue;
    r.t[i] = r.timed ? o.time[i] : o.order_known ? count[line_of(i)]++ : 0.0;
    first[line_of(i)] = std::min(first[line_of(i)], r.t[i]);
  }
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!r.moved[i]) continue;
    r.t[i] -= first[line_of(i)];
    r.duration = std::max(r.duration, r.t[i]);
  }
}

inline void fill_temperatures(const Observations& o, AxisReadings& r) {
  r.temperature = complete(o.material, r.moved);
  if (!r.temperature) return;
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (r.moved[i]) sum += o.material[i], ++n;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (r.moved[i]) r.K[i] = o.material[i] - sum / n;
}

}  // namespace detail

/// Fails if the readings do not move this axis in a known direction.
inline Expected<AxisReadings> readings_of(const Observations& o, const Axis& axis) {
  const Observations::AxisColumn* column = nullptr;
  for (const auto& c : o.axes)
    if (c.axis == axis.name && !c.approach.empty()) column = &c;
  if (column == nullptr)
    return fail("the readings do not say from where axis " + axis.name + " came");
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
  for (std::size_t i = 0; i < n; ++i)
    if (r.moved[i]) r.p[i] = r.theta[i] - (low + high) / 2.0;
  detail::fill_times(o, r);
  detail::fill_temperatures(o, r);
  return r;
}

inline bool from_both_directions(const AxisReadings& r) {
  return std::any_of(r.d.begin(), r.d.end(), [](double d) { return d > 0.0; }) &&
         std::any_of(r.d.begin(), r.d.end(), [](double d) { return d < 0.0; });
}

/// The positions that were measured, each once, ascending, from the middle of the stretch. What
/// lies nearer than 1e-9 of the length is one target.
inline std::vector<double> targets_of(const AxisReadings& r) {
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

/// A column for each of `values`, which are called as value(readings, row) for the rows in which
/// the axis moved; the others are 0.
template <class... Values>
Expected<Effect::Columns> columns_of(const Observations& o, const Axis& axis, Values... values) {
  const auto r = readings_of(o, axis);
  if (!r) return fail(r.error());
  Effect::Columns columns(sizeof...(values), std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!r->moved[i]) continue;
    std::size_t k = 0;
    ((columns[k++][i] = values(*r, i)), ...);
  }
  return columns;
}

}  // namespace nonio
