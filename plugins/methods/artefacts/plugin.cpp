// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

namespace nonio::artefacts_method {

namespace {

Method of_artefact(const char* name, const char* summary, Measurement::Motion motion) {
  return {.info = {name,
                   "1.0",
                   summary,
                   {{.name = "artefact",
                     .default_value = std::string(),
                     .unit = "",
                     .help = "Name of the artefact whose balls were probed, or whose certificate "
                             "this is; the same in every placement.",
                     .max = 60.0,
                     .required = true,
                     .missing = "a name of the artefact, \"plate\"",
                     .expected = "expected up to 60 characters without / and \\",
                     .forbidden = "/\\\n\t"}}},
          .motion = motion};
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(of_artefact("artefact", "Balls of an artefact, probed in one of its placements",
                           Measurement::Motion::placements));
  registry.add(of_artefact("artefact-certificate",
                           "Calibrated positions of the balls of an artefact",
                           Measurement::Motion::none));
}

}  // namespace nonio::artefacts_method
