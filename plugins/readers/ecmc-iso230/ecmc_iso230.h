// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::ecmc_iso230 {

/// Reference positions that ecmc's tools extract from a log (_ISO230.dat).
Reader reader();

}  // namespace nonio::ecmc_iso230
