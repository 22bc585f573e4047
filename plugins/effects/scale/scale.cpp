// SPDX-License-Identifier: Apache-2.0
// deviation = a p; p: position from the center of the measured range, m or rad; a: m/m or rad/rad.
// Source: catalog EFFECTS in docs/formulas.md.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::scale {

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->length > 0.0;
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  NONIO_TRY(auto r, readings_of(o, axis));
  return Effect::Columns{std::move(r.p)};
}

NONIO_PLUGIN(registry) {
  registry.add(
      Effect{.info = {"scale", "1.0.0",
                      "Deviation proportional to the travel: pitch or scale error, expansion"},
             .linear = {{"a", "slope of the deviation over the travel",
                         Quantity::deviation_per_length, Quantity::deviation_per_angle}},
             .shapes = {},
             .compensable = true,
             .applies = applies,
             .columns = columns});
}

}  // namespace nonio::scale
