// SPDX-License-Identifier: Apache-2.0
// deviation = a p; p: position from the center of the measured range, m or rad; a: m/m or rad/rad.
// part-scale: the same in the frame of a part, if parts were turned by different angles.
// Source: catalog EFFECTS in docs/formulas.md.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"
#include "nonio/sdk/space_readings.h"

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
  const Effect scale{
      .info = {"scale", "1.0.0",
               "Deviation proportional to the travel: pitch or scale error, expansion"},
      .linear = {{"a", "slope of the deviation over the travel", Quantity::deviation_per_length,
                  Quantity::deviation_per_angle}},
      .shapes = {},
      .compensable = true,
      .of_part = "part-scale",
      .applies = applies,
      .columns = columns};
  registry.add(scale);
  registry.add(in_frame_of_parts(
      scale, {"part-scale", "1.0.0",
              "A stretch along one direction that turns with the part: of fixture or measuring "
              "machine"}));
}

}  // namespace nonio::scale
