// SPDX-License-Identifier: Apache-2.0
// deviation = d (a sin(theta) + b cos(theta))/2; d: direction of approach, +1 or -1; theta: angle
// of the axis, rad; a, b: rad.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::elastic_reversal {

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && axis.rotary && r->length > 0.0 && from_both_directions(*r);
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  return columns_of(
      o, axis,
      [](const AxisReadings& r, std::size_t i) { return r.d[i] * std::sin(r.theta[i]) / 2.0; },
      [](const AxisReadings& r, std::size_t i) { return r.d[i] * std::cos(r.theta[i]) / 2.0; });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"elastic-reversal", "1.0.0",
               "Reversal of changing sign over the turn: elasticity under an unbalance"},
      .linear = {{"a", "part with the sine", Quantity::deviation, Quantity::angular_deviation},
                 {"b", "part with the cosine", Quantity::deviation, Quantity::angular_deviation}},
      .shapes = {},
      .applies = applies,
      .columns = columns,
      .why_not = [](const Observations& o, const Axis& axis) {
        return axis.rotary ? one_direction(o, axis) : WhyNot{};
      }});
}

}  // namespace nonio::elastic_reversal
