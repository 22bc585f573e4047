// SPDX-License-Identifier: Apache-2.0
// deviation = g (p - fixed) t; p: position from the middle of the measured range, m or rad; fixed:
// position of the fixed point in the manifest from the same middle, otherwise 0 (another fixed
// point only adds a drift of the zero); t: time since the first reading of its line, s; g: 1/s.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::growth_drift {

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->length > 0.0 && r->duration > 0.0 && !is_circle_without_times(o);
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  const bool known = axis.fixed_point && !axis.rotary;
  return columns_of(o, axis, [&](const AxisReadings& r, std::size_t i) {
    return (r.p[i] - (known ? *axis.fixed_point - r.middle : 0.0)) * r.t[i];
  });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"growth-drift", "1.0.0",
               "Readings fan out in time: screw or scale warms while it is measured"},
      .linear = {{"g", "growth of the slope in time", Quantity::growth, Quantity::angular_growth}},
      .shapes = {},
      .applies = applies,
      .columns = columns,
      .why_not = no_order});
}

}  // namespace nonio::growth_drift
