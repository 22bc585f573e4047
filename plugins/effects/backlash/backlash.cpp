// SPDX-License-Identifier: Apache-2.0
// deviation = b d/2; d: direction of approach, +1 or -1; b: m or rad, negative for lost motion.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::backlash {

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && from_both_directions(*r);
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  return columns_of(o, axis, [](const AxisReadings& r, std::size_t i) { return r.d[i] / 2.0; });
}

NONIO_PLUGIN(registry) {
  registry.add(
      Effect{.info = {"backlash", "1.0.0",
                      "Constant reversal: lost motion (b < 0) or over-compensation (b > 0)"},
             .linear = {{"b", "reversal, mean(+) less mean(-)", Quantity::deviation,
                         Quantity::angular_deviation}},
             .shapes = {},
             .compensable = true,
             .applies = applies,
             .columns = columns,
             .why_not = one_direction});
}

}  // namespace nonio::backlash
