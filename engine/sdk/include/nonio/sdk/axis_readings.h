// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"

/// Quantities of the readings of one axis, from which effects compute their columns. theta is the
/// commanded position, [a, b] the measured range, and i an index of the readings for which the axis
/// was moved:
///
///     length   L = b - a                        m, rad
///     middle   m = (a + b) / 2                  m, rad
///     p_i      = theta_i - m                    m, rad, in [-L/2, L/2]
///     d_i      = +1 reached from below, -1 from above
///     t_i      = time since the first reading of its line, s
///     K_i      = material temperature - its mean over the readings, K
///
///       a              m              b
///     -------|---------------+---------------|------>  coordinate of the axis
///            p < 0   |   p > 0
///            d = +1  ----->    <-----  d = -1
///
/// The signs of deviations are defined in docs/conventions.md.
namespace nonio {

/// The readings of one axis. Each vector except `interpolated` has observations.size() entries; an
/// entry is 0 if the axis was not moved.
struct AxisReadings {
  std::vector<char> moved;    ///< 1 if the axis was moved
  std::vector<double> p;      ///< position relative to the middle of the measured range, m or rad
  std::vector<double> theta;  ///< commanded position, m or rad
  std::vector<double> d;      ///< direction of approach: +1 or -1
  std::vector<double> t;      ///< time since the first reading of its line, s
  /// Material temperature minus its mean, K; 0 if it was not measured.
  std::vector<double> K;
  double length = 0.0;    ///< length of the measured range, m or rad
  double duration = 0.0;  ///< longest time from the first to the last reading of a line, s
  /// Whether `t` is from measured times. Otherwise `t` is the index of the reading within its line
  /// (one reading is one second), or 0 if the order of the readings is not known.
  bool timed = false;
  double middle = 0.0;  ///< commanded position of the middle of the measured range, m or rad
  /// Whether every reading has a material temperature, either measured or interpolated linearly in
  /// time; at the ends of a line the nearest temperature is used.
  bool temperature = false;
  std::vector<std::uint32_t> interpolated;  ///< rows with an interpolated temperature
};

namespace detail {

/// `fill_times` sets `t`, `timed` and `duration`; `fill_temperatures` sets `K`, `temperature` and
/// `interpolated`. A gap of temperatures may last a quarter of its line, and the nearest
/// temperature at an end of a line may be an eighth of the line away. `temperature` is false if a
/// gap is longer, or if a line with gaps has fewer than three temperatures.
void fill_times(const Observations& o, AxisReadings& r);
void fill_temperatures(const Observations& o, AxisReadings& r);

}  // namespace detail

/// Positions must be finite; times and temperatures may be NaN. Error: the readings do not move
/// this axis, or do not state the direction of approach.
Expected<AxisReadings> readings_of(const Observations& o, const Axis& axis);

/// Whether positions were approached from below and from above.
bool from_both_directions(const AxisReadings& r);

/// Returns candidate positions of the fixed point of a screw or scale, m or rad from the middle of
/// the measured range. One position if the manifest states it; the middle for a rotary axis or for
/// readings of several axes; otherwise seven positions up to 1.5 times the length of the range from
/// its middle. Empty if the readings do not move the axis.
std::vector<double> fixed_points(const Observations& o, const Axis& axis);

Effect::Shape fixed_point_shape();

/// Whether readings are of a circle, sensed along its radius, without times: a circle takes seconds,
/// in which nothing warms.
bool is_circle_without_times(const Observations& o);

/// Returns "no-times" for a circle without times, "no-order" if the order of the readings in time is
/// not known, otherwise an empty id.
WhyNot no_order(const Observations& o, const Axis& axis);

/// Returns "one-direction" if all positions were approached from one side, otherwise an empty id.
WhyNot one_direction(const Observations& o, const Axis& axis);

/// Returns the distinct positions in ascending order, relative to the middle of the measured range,
/// m or rad. Positions closer than 1e-9 of its length are one target.
std::vector<double> targets_of(const AxisReadings& r);

/// Each function value(readings, row) gives one column; it is called for rows in which the axis was
/// moved, and other rows are 0. Error: that of `readings_of`.
template <class... Values>
Expected<Effect::Columns> columns_of(const Observations& o, const Axis& axis, Values... values) {
  NONIO_TRY(const auto r, readings_of(o, axis));
  Effect::Columns columns(sizeof...(values), std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!r.moved[i]) continue;
    std::size_t k = 0;
    ((columns[k++][i] = values(r, i)), ...);
  }
  return columns;
}

}  // namespace nonio
