// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::linuxcnc_probe {

/// Reads LinuxCNC probe logs (PROBEOPEN) of touches on a ball, and fits its centers.
Reader reader();

}  // namespace nonio::linuxcnc_probe
