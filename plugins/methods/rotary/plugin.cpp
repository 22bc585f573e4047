// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

namespace nonio::rotary_method {

namespace {

Method of_rotary_axis(const char* name, const char* summary) {
  return {.info = {name,
                   "1.0",
                   summary,
                   {{.name = "axis",
                     .default_value = std::string(),
                     .unit = "",
                     .help = "The rotary axis with the measured balls.",
                     .required = true,
                     .missing = "which axis of the machine was measured"}}}};
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(of_rotary_axis(
      "ball-centres", "Centres of balls that turn with a rotary axis, probed at its targets"));
  registry.add(of_rotary_axis(
      "rtcp", "Deviation of a ball that the control follows while a rotary axis turns"));
}

}  // namespace nonio::rotary_method
