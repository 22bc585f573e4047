// SPDX-License-Identifier: Apache-2.0
// deviation = a sin(n theta) + b cos(n theta); theta: angle of the axis, rad; n: `teeth` of the
// manifest, periods in a revolution; a, b: rad.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::gear_mesh {

/// One and two periods are the effects eccentricity and harmonic2.
static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && axis.rotary && axis.teeth && *axis.teeth > 2 && r->length > 0.0;
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  if (!axis.teeth) return fail("gear-mesh: axis " + axis.name + " has no `teeth` in the manifest");
  const double n = *axis.teeth;
  return columns_of(
      o, axis, [n](const AxisReadings& r, std::size_t i) { return std::sin(n * r.theta[i]); },
      [n](const AxisReadings& r, std::size_t i) { return std::cos(n * r.theta[i]); });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"gear-mesh", "1.0.0", "Once per tooth: period of worm or gear"},
      .linear = {{"a", "part with the sine", Quantity::deviation, Quantity::angular_deviation},
                 {"b", "part with the cosine", Quantity::deviation, Quantity::angular_deviation}},
      .shapes = {},
      .compensable = true,
      .applies = applies,
      .columns = columns});
}

}  // namespace nonio::gear_mesh
