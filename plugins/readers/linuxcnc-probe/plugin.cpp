// SPDX-License-Identifier: Apache-2.0
#include "linuxcnc_probe.h"

namespace nonio::linuxcnc_probe {

NONIO_PLUGIN(registry) { registry.add(linuxcnc_probe::reader()); }

}  // namespace nonio::linuxcnc_probe
