// SPDX-License-Identifier: Apache-2.0
#include "linuxcnc_probe.h"

NONIO_PLUGIN(registry) { registry.add(nonio::linuxcnc_probe::reader()); }
