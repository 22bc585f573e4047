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

/// What effects on one axis are made of. With theta the commanded position, [a, b] the stretch that
/// was measured, and the readings i that moved the axis:
///
///     length   L = b - a                        m, rad
///     middle   m = (a + b) / 2                  m, rad
///     p_i      = theta_i - m                    m, rad, in [-L/2, L/2]
///     d_i      = +1 reached from below, -1 from above
///     t_i      = time since the first reading of its line, s
///     K_i      = material temperature - its mean over the readings, K
///
///            a               m               b
///     -------|---------------+---------------|------> coordinate of the axis
///                     p < 0  |  p > 0
///                  d = +1  ----->   <-----  d = -1
///
/// docs/conventions.md has the signs of deviations.
namespace nonio {

/// Each column has observations.size() entries, 0 in rows in which the axis did not move.
struct AxisReadings {
  std::vector<char> moved;    ///< 1 where the axis moved
  std::vector<double> p;      ///< position from the middle of the measured stretch, m or rad
  std::vector<double> theta;  ///< position as commanded, m or rad
  std::vector<double> d;      ///< direction of approach: +1, -1
  std::vector<double> t;      ///< since the first reading of its line, s
  std::vector<double> K;  ///< material temperature less its mean, K; 0 everywhere if not measured
  double length = 0.0;    ///< of the measured stretch, m or rad
  double duration = 0.0;  ///< of the longest line, s
  /// False: one reading counts as one second, in the order of the rows; where that is not known
  /// either, `t` is 0 everywhere.
  bool timed = false;
  double middle = 0.0;  ///< of the measured stretch, as commanded, m or rad
  /// Every reading has a material temperature; of those in `interpolated` it is interpolated
  /// linearly in time between their neighbours.
  bool temperature = false;
  std::vector<std::uint32_t> interpolated;  ///< rows
};

namespace detail {

/// Fill `t`, `timed`, `duration`; and `K`, `temperature`, `interpolated`. A gap of temperatures is
/// filled where it is at most a quarter of its line long, and an end at most an eighth away.
void fill_times(const Observations& o, AxisReadings& r);
void fill_temperatures(const Observations& o, AxisReadings& r);

}  // namespace detail

/// An error if the readings do not move this axis in a known direction. Range: finite positions;
/// times and temperatures may be NaN.
Expected<AxisReadings> readings_of(const Observations& o, const Axis& axis);

/// Some were reached from below, some from above.
bool from_both_directions(const AxisReadings& r);

/// Where to look for the point of a screw or scale that stays where it is, from the middle of the
/// stretch, m: known from the manifest, else the middle (rotary axes, several axes), else also
/// a bearing at an end or anywhere between. Steps of about 20 deg of the angle between what moves
/// all readings alike and what fans them out.
std::vector<double> fixed_points(const Observations& o, const Axis& axis);

Effect::Shape fixed_point_shape();

/// Why an effect that requests the course of time does not apply.
WhyNot no_order(const Observations& o, const Axis& axis);

/// Why an effect that requests both directions of approach does not apply.
WhyNot one_direction(const Observations& o, const Axis& axis);

/// The positions that were measured, each once, ascending, from the middle of the stretch.
/// Positions nearer than 1e-9 of the length are one target.
std::vector<double> targets_of(const AxisReadings& r);

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
