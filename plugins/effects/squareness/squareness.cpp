// SPDX-License-Identifier: Apache-2.0
// Chain bed - X - Y - Z - tool, x, y, z from the corner of the measured volume:
//     XY (C0Y):  e_x = -c y     XZ (B0Z):  e_x = +c z     YZ (A0Z):  e_y = -c z
// c: rad; signs of ISO 230-1: C0Y > 0 rotates +Y towards -X, B0Z > 0 rotates +Z towards +X, A0Z > 0
// rotates +Z towards -Y.
#include "nonio/sdk/space_readings.h"

namespace nonio::squareness {

namespace {

struct Pair {
  const char* name;
  std::size_t error, lever;
  double sign;
};
constexpr Pair pairs[] = {{"XY", 0, 1, -1.0}, {"XZ", 0, 2, +1.0}, {"YZ", 1, 2, -1.0}};

std::vector<std::string> of(const Observations& o) {
  std::vector<std::string> names;
  if (of_ball_centres(o)) return names;
  const SpaceReadings s = space_of(o);
  for (const Pair& pair : pairs)
    if (s.moves(pair.lever) && varies_where_sensed(o, s, pair.lever, pair.error))
      names.emplace_back(pair.name);
  return names;
}

Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                  const std::vector<double>&) {
  const SpaceReadings s = space_of(o);
  for (const Pair& pair : pairs) {
    if (axis.name != pair.name) continue;
    Effect::Columns out(1, std::vector<double>(o.size()));
    for (std::size_t i = 0; i < o.size(); ++i)
      out[0][i] = pair.sign * s.lever(pair.lever, i) * o.sense_of(i)[pair.error];
    return out;
  }
  return fail("squareness: expected XY, XZ or YZ, found " + axis.name);
}

}  // namespace

NONIO_PLUGIN(registry) {
  const Effect squareness{
      .info = {"squareness", "1.0.0", "Two axes that are not square to each other"},
      .linear = {{"c", "squareness (ISO 230-1: C0Y, B0Z, A0Z)", Quantity::small_angle}},
      .shapes = {},
      .compensable = true,
      .of_part = "part-squareness",
      .applies = [](const Observations&, const Axis&) { return true; },
      .columns = columns,
      .instances = of};
  registry.add(squareness);
  registry.add(
      in_frame_of_parts(squareness, {"part-squareness", "1.0.0",
                                     "A squareness that turns with the part: of fixture or "
                                     "measuring machine"}));
}

}  // namespace nonio::squareness
