// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

namespace nonio::heat_method {

namespace {

Option sensor_distance() {
  return {.name = "sensor_distance_mm",
          .default_value = 0.0,
          .unit = "mm",
          .help =
              "Distance along the spindle between the sensors 1 and 2 of a nest (x1_um and "
              "x2_um, y1_um and y2_um): their difference then gives the tilt.",
          .min = 1.0,
          .max = 1e4,
          .expected = "expected a distance from 1 to 10000 mm"};
}

Option period() {
  return {.name = "period",
          .default_value = std::vector<double>{},
          .unit = "s",
          .help =
              "From and to (time_s) of the readings that are used, the end not included; "
              "temperatures and speeds before it still count for what lags behind them.",
          .expected = "expected two times, the first one earlier"};
}

Option unit() {
  return {.name = "unit",
          .default_value = std::string("um"),
          .unit = "",
          .help =
              "Which displacements are evaluated: columns `NAME_um`, or tilts in columns "
              "`NAME_arcsec`. A file with both has a measurement for each.",
          .choices = {"um", "arcsec"}};
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(Method{.info = {"thermal",
                               "1.0",
                               "Drift of sensors or of an exercised axis over time",
                               {{.name = "axis",
                                 .default_value = std::string(),
                                 .unit = "",
                                 .help = "The linear axis that is exercised; without it the "
                                         "columns are those of sensors."},
                                period(),
                                unit(),
                                sensor_distance()}},
                      .motion = Measurement::Motion::time});
  registry.add(Method{.info = {"spindle",
                               "1.0",
                               "Displacement of a rotating test mandrel over its angle",
                               {sensor_distance()}},
                      .motion = Measurement::Motion::none});
  registry.add(
      Method{.info = {"lengths", "1.0", "Lengths of calibrated artefacts in the working space"},
             .motion = Measurement::Motion::none});
}

}  // namespace nonio::heat_method
