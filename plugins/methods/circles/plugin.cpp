// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

namespace nonio::circles_method {

namespace {

Method circle() {
  return {
      .info = {"circle",
               "1.0",
               "Radial deviation on a circle of two linear axes",
               {{.name = "plane",
                 .default_value = std::string(),
                 .unit = "",
                 .help = "Plane of a circle. Angles and counter-clockwise motion go from its first "
                         "axis to its second: XY is G17, ZX is G18, YZ is G19.",
                 .choices = {"XY", "YZ", "ZX"},
                 .required = true,
                 .missing = "the plane of the circle, \"XY\""},
                {.name = "radius_mm",
                 .default_value = 0.0,
                 .unit = "mm",
                 .help = "Commanded radius of a circle.",
                 .min = 1.0,
                 .max = 1e4,
                 .required = true,
                 .missing = "the commanded radius of the circle",
                 .expected = "expected a radius from 1 to 10000 mm"},
                {.name = "centre",
                 .default_value = NumberTable{},
                 .unit = "mm",
                 .help = "Commanded axis positions at the centre of a circle, "
                         "{ X = 400, Y = 300 }.",
                 .required = true,
                 .missing = "the axis positions at the centre of the circle, "
                            "{ X = 400, Y = 300 }"}}},
      .motion = Measurement::Motion::path};
}

}  // namespace

NONIO_PLUGIN(registry) { registry.add(circle()); }

}  // namespace nonio::circles_method
