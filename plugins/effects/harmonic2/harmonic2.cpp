// SPDX-License-Identifier: Apache-2.0
// deviation = a sin(2 theta) + b cos(2 theta); theta: angle of the axis, rad; a, b: rad.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::harmonic2 {

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && axis.rotary && r->length > 0.0;
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  return columns_of(
      o, axis, [](const AxisReadings& r, std::size_t i) { return std::sin(2.0 * r.theta[i]); },
      [](const AxisReadings& r, std::size_t i) { return std::cos(2.0 * r.theta[i]); });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"harmonic2", "1.0.0", "Twice per revolution: oval or tilted scale"},
      .linear = {{"a", "part with the sine", Quantity::deviation, Quantity::angular_deviation},
                 {"b", "part with the cosine", Quantity::deviation, Quantity::angular_deviation}},
      .shapes = {},
      .compensable = true,
      .applies = applies,
      .columns = columns});
}

}  // namespace nonio::harmonic2
