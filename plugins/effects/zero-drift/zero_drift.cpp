// SPDX-License-Identifier: Apache-2.0
// deviation = z t; t: time since the first reading of its line, s; z: m/s or rad/s.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::zero_drift {

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->duration > 0.0;
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  return columns_of(o, axis, [](const AxisReadings& r, std::size_t i) { return r.t[i]; });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"zero-drift", "1.0.0",
               "All readings move together in time: dead path, structure against instrument"},
      .linear = {{"z", "drift of the zero", Quantity::deviation_per_time,
                  Quantity::angle_per_time}},
      .shapes = {},
      .applies = applies,
      .columns = columns,
      .why_not = no_order});
}

}  // namespace nonio::zero_drift
