// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

namespace nonio::diagonals_method {

namespace {

Option end(const char* name, const char* help) {
  return {.name = name,
          .default_value = NumberTable{},
          .unit = "mm",
          .help = help,
          .required = true,
          .missing = "the axis positions of that end, { X = 0, Y = 0 }"};
}

Method between_ends(const char* name, const char* summary) {
  return {
      .info = {name,
               "1.0",
               summary,
               {end("from", "Axis positions at the start of a diagonal, { X = 0, Y = 0 }."),
                end("to", "Axis positions at the end of a diagonal, { X = 12000, Y = 9000 }.")}}};
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(between_ends("diagonal", "Deviation along a diagonal, at stops of all its axes"));
  registry.add(
      between_ends("step-diagonal", "Deviation along a diagonal, after each move of one axis"));
}

}  // namespace nonio::diagonals_method
