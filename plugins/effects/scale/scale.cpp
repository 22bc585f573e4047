// SPDX-License-Identifier: Apache-2.0
// deviation = a p; p: position from the center of the measured range, m or rad; a: m/m or rad/rad.
// part-scale: the same in the frame of a part, if parts were turned by different angles.
// Source: catalog EFFECTS in docs/formulas.md.
#include <cmath>

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

static std::vector<std::string> of_bodies(const Observations& o) {
  return in_bodies(o) ? std::vector<std::string>{"X", "Y"} : std::vector<std::string>();
}

static Expected<Effect::Columns> columns_of_bodies(const Observations& o, const Axis& place,
                                                   const std::vector<double>&) {
  const auto in = in_bodies(o);
  if (!in) return fail("part-scale: expected parts that were turned by different angles");
  Effect::Columns out(1, std::vector<double>(o.size(), 0.0));
  const std::size_t k = coordinate_of(place.name);
  const auto* along = in->axis(place.name);
  if (k > 1 || along == nullptr) return fail("part-scale: expected X or Y, found " + place.name);
  for (std::size_t i = 0; i < o.size(); ++i)
    if (std::isfinite(along->position[i])) out[0][i] = along->position[i] * in->sense[i][k];
  return out;
}

NONIO_PLUGIN(registry) {
  registry.add(
      Effect{.info = {"scale", "1.0.0",
                      "Deviation proportional to the travel: pitch or scale error, expansion"},
             .linear = {{"a", "slope of the deviation over the travel",
                         Quantity::deviation_per_length, Quantity::deviation_per_angle}},
             .shapes = {},
             .compensable = true,
             .of_part = "part-scale",
             .applies = applies,
             .columns = columns});
  registry.add(Effect{
      .info = {"part-scale", "1.0.0",
               "A stretch along one direction that turns with the part: of fixture or measuring "
               "machine"},
      .linear = {{"a", "stretch in the frame of the part", Quantity::deviation_per_length}},
      .shapes = {},
      .compensable = false,
      .applies = [](const Observations&, const Axis&) { return true; },
      .columns = columns_of_bodies,
      .instances = of_bodies});
}

}  // namespace nonio::scale
