// SPDX-License-Identifier: Apache-2.0
// deviation = g p t; p: position from the middle of the measured stretch, m or rad; t: time since
// the first reading of its line, s; g: 1/s.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

using namespace nonio;

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->length > 0.0 && r->duration > 0.0;
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  return columns_of(o, axis, [](const AxisReadings& r, std::size_t i) { return r.p[i] * r.t[i]; });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"growth-drift", "1.0.0",
               "Readings fan out in time: screw or scale warms while it is measured"},
      .linear = {{"g", "growth of the slope in time", Quantity::growth, Quantity::angular_growth}},
      .shapes = {},
      .applies = applies,
      .columns = columns});
}
