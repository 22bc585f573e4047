// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::ecmc_iso230 {

/// Reads reference positions that the ecmc tools extract from a log (_ISO230.dat).
Reader reader();

}  // namespace nonio::ecmc_iso230
