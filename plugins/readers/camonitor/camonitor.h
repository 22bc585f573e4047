// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::camonitor {

/// Reads logs of EPICS camonitor from tests whose steps are numbered by the ecmc tools.
Reader reader();

}  // namespace nonio::camonitor
