// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::camonitor {

/// Logs of EPICS' camonitor, of a test whose steps are numbered by ecmc's tools.
Reader reader();

}  // namespace nonio::camonitor
