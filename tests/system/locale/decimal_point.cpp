// SPDX-License-Identifier: Apache-2.0
// Writes 1.5 as the locale of its process does.
#include <cstdio>

#include "nonio/sdk/plugin.h"

namespace {

using namespace nonio;

Expected<OutputResult> write(const OutputInput&) {
  char number[16];
  std::snprintf(number, sizeof number, "%.1f\n", 1.5);
  OutputResult result;
  result.artifacts.push_back({"decimal-point.txt", number});
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(Output{{"decimal-point", "1", "Writes 1.5 with printf", {}},
                      [](const Campaign&) { return true; },
                      write,
                      nullptr});
}
