// SPDX-License-Identifier: Apache-2.0
// deviation = c d p/2; d: direction of approach, +1 or -1; p: position from the center of the
// measured range, m or rad; c: slope of the reversal along the travel, m/m or rad/rad.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::backlash_slope {

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->length > 0.0 && from_both_directions(*r);
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  return columns_of(o, axis,
                    [](const AxisReadings& r, std::size_t i) { return r.d[i] * r.p[i] / 2.0; });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{.info = {"backlash-slope", "1.0.0",
                               "Reversal that grows along the travel: wind-up of a long screw"},
                      .linear = {{"c", "growth of the reversal along the travel",
                                  Quantity::deviation_per_length, Quantity::deviation_per_angle}},
                      .shapes = {},
                      .applies = applies,
                      .columns = columns,
                      .why_not = one_direction});
}

}  // namespace nonio::backlash_slope
