// SPDX-License-Identifier: Apache-2.0
// deviation = w (p - fixed) (1 - exp(-t/tau)); p: position from the middle of the measured range,
// fixed: that of the fixed point, m or rad; t: time since the first reading of its line, s; tau:
// time constant, s; w: m/m or rad/rad.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::warm_up {

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->length > 0.0 && r->duration > 0.0 && !is_circle_without_times(o);
}

/// Time constants with a constant ratio. Below 1/40 of the duration, the warm-up ends within a few
/// readings. Above 1.5 durations, it cannot be distinguished from the straight line of
/// growth-drift.
static std::vector<double> grid(const Observations& o, const Axis& axis) {
  constexpr int count = 14;
  constexpr double shortest = 1.0 / 40.0, longest = 1.5;  // relative to the duration
  const auto r = readings_of(o, axis);
  if (!r || !(r->duration > 0.0)) return {};
  std::vector<double> taus;
  for (int k = 0; k < count; ++k)
    taus.push_back(r->duration * shortest * std::pow(longest / shortest, k / (count - 1.0)));
  return taus;
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>& shape) {
  if (shape.size() != 2 || !(shape[0] > 0.0) || !std::isfinite(shape[1]))
    return fail("warm-up: expected a time constant above 0 and a fixed point");
  return columns_of(o, axis,
                    [tau = shape[0], fixed = shape[1]](const AxisReadings& r, std::size_t i) {
                      return -(r.p[i] - fixed) * std::expm1(-r.t[i] / tau);
                    });
}

NONIO_PLUGIN(registry) {
  registry.add(
      Effect{.info = {"warm-up", "1.0.0",
                      "Screw or scale warms and levels off: growth with a time constant"},
             .linear = {{"w", "final growth of the slope", Quantity::deviation_per_length,
                         Quantity::deviation_per_angle}},
             .shapes = {{{"tau", "time constant", Quantity::time}, grid}, fixed_point_shape()},
             .applies = applies,
             .columns = columns,
             .why_not = no_order});
}

}  // namespace nonio::warm_up
