// SPDX-License-Identifier: Apache-2.0
#include "ecmc_iso230.h"

namespace nonio::ecmc_iso230 {

NONIO_PLUGIN(registry) { registry.add(ecmc_iso230::reader()); }

}  // namespace nonio::ecmc_iso230
