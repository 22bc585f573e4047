// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

namespace nonio::runs_method {

namespace {

Option axis() {
  return {.name = "axis",
          .default_value = std::string(),
          .unit = "",
          .help = "The axis that moves.",
          .required = true,
          .missing = "which axis of the machine was measured"};
}

Method positioning() {
  return {.info = {"axis",
                   "1.0",
                   "Deviation along an axis at its targets, approached in both directions",
                   {axis(),
                    {.name = "order",
                     .default_value = std::string(),
                     .unit = "",
                     .help = "Order of the readings in a file without times: forward and back, run "
                             "by run (pendulum), in the order of the rows (as-listed), or unknown: "
                             "then nothing is concluded from time.",
                     .choices = {"pendulum", "as-listed", "unknown"}},
                    {.name = "side",
                     .default_value = std::string(),
                     .unit = "",
                     .help = "For a gantry axis with a scale on each side: the side of this line. "
                             "Each side has its own table.",
                     .choices = {"master", "slave"}}}}};
}

Method straightness() {
  return {
      .info = {"straightness",
               "1.0",
               "Deviation across a linear axis at its targets",
               {axis(),
                {.name = "lateral",
                 .default_value = std::string(),
                 .unit = "",
                 .help = "The axis in whose direction a straightness deviation is sensed.",
                 .required = true,
                 .missing = "the axis in whose direction the deviation was measured"},
                {.name = "reversal_of",
                 .default_value = std::string(),
                 .unit = "",
                 .help = "The measurement of the same line before the straightedge was turned "
                         "over: both give the straightness of the motion without that of the "
                         "straightedge."},
                {.name = "square",
                 .default_value = std::string(),
                 .unit = "",
                 .help = "The [[square]] on whose face the deviation was read: two lines, each "
                         "axis towards the other, give the squareness."},
                {.name = "square_turned",
                 .default_value = false,
                 .unit = "",
                 .help = "Whether the square had been turned over about one of its faces: its own "
                         "error then drops out of the mean."}}}};
}

Method angle() {
  return {.info = {"angle",
                   "1.0",
                   "Rotation of what a linear axis carries, at its targets",
                   {axis(),
                    {.name = "about",
                     .default_value = std::string(),
                     .unit = "",
                     .help = "The axis of the rotation (yaw of X: Z), right-handed positive.",
                     .choices = {"X", "Y", "Z"},
                     .required = true},
                    {.name = "foot_mm",
                     .default_value = 0.0,
                     .unit = "mm",
                     .help = "Length of the foot or mirror base of a level or autocollimator that "
                             "was moved by its own length along the line: the angles then give "
                             "the straightness.",
                     .min = 0.001,
                     .expected = "expected a length above 0"}}}};
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(positioning());
  registry.add(straightness());
  registry.add(angle());
}

}  // namespace nonio::runs_method
