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
/// commanded position, [a, b] the measured stretch, and i runs over the readings that moved the
/// axis:
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

/// The readings of one axis. Each vector, except `interpolated`, has observations.size() entries
/// and is 0 in rows in which the axis did not move.
struct AxisReadings {
  std::vector<char> moved;    ///< 1 where the axis moved
  std::vector<double> p;      ///< position from the middle of the measured stretch, m or rad
  std::vector<double> theta;  ///< position as commanded, m or rad
  std::vector<double> d;      ///< direction of approach: +1, -1
  std::vector<double> t;      ///< time since the first reading of its line, s
  /// material temperature minus its mean, K; 0 everywhere if it was not measured
  std::vector<double> K;
  double length = 0.0;    ///< length of the measured stretch, m or rad
  double duration = 0.0;  ///< time from first to last reading of the longest line, s
  /// Whether `t` comes from measured times. If false, `t` counts the readings of a line in the
  /// order of the rows (one reading is one second); if that order is not known either, `t` is 0
  /// everywhere.
  bool timed = false;
  double middle = 0.0;  ///< commanded position of the middle of the measured stretch, m or rad
  /// Whether every reading has a material temperature. In the rows `interpolated` it is
  /// interpolated linearly in time between neighboring readings; at the ends of a line it is the
  /// nearest one.
  bool temperature = false;
  std::vector<std::uint32_t> interpolated;  ///< rows with an interpolated temperature
};

namespace detail {

/// `fill_times` fills `t`, `timed` and `duration`; `fill_temperatures` fills `K`, `temperature` and
/// `interpolated`. A gap of temperatures is interpolated if it lasts at most a quarter of its line.
/// At the ends of a line, the nearest temperature is used if it is at most an eighth of the line
/// away. Otherwise `temperature` is false, and also if a line with gaps has fewer than three
/// temperatures.
void fill_times(const Observations& o, AxisReadings& r);
void fill_temperatures(const Observations& o, AxisReadings& r);

}  // namespace detail

/// Returns the readings of one axis. Error: the readings do not move this axis, or do not state the
/// direction of approach. Positions must be finite; times and temperatures may be NaN.
Expected<AxisReadings> readings_of(const Observations& o, const Axis& axis);

/// Returns whether some positions were reached from below and some from above.
bool from_both_directions(const AxisReadings& r);

/// Returns candidate positions of the fixed point of a screw or scale, in m from the middle of the
/// measured stretch (rad for a rotary axis): for a linear axis, the position that the manifest
/// states, if any. Otherwise it returns only the middle for a rotary axis or for readings of
/// several axes, and for a single linear axis seven positions up to 1.5 times the length of the
/// stretch from its middle. Empty if the readings do not move the axis.
std::vector<double> fixed_points(const Observations& o, const Axis& axis);

Effect::Shape fixed_point_shape();

/// Returns the reason "no-order" if the readings do not state their order in time, else an empty
/// id. For effects that depend on time.
WhyNot no_order(const Observations& o, const Axis& axis);

/// Returns the reason "one-direction" if all positions were approached from one side, else an empty
/// id. For effects that need both directions.
WhyNot one_direction(const Observations& o, const Axis& axis);

/// Returns the distinct measured positions, ascending, relative to the middle of the stretch, m or
/// rad. Positions closer than 1e-9 of the length are one target.
std::vector<double> targets_of(const AxisReadings& r);

/// Computes one column for each function in `values`, called as value(readings, row) for the rows
/// in which the axis moved; other rows are 0. Error: `readings_of` returns an error.
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
