// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::linuxcnc_probe {

/// Logs of LinuxCNC's (PROBEOPEN ...): touches of a ball, whose centres are fitted.
Reader reader();

}  // namespace nonio::linuxcnc_probe
