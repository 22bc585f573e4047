// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

namespace nonio::observations_method {

NONIO_PLUGIN(registry) {
  registry.add(nonio::Method{
      .info = {"observations", "1.0",
               "Any readings: positions of all axes, direction of sensing, deviation"}});
}

}  // namespace nonio::observations_method
