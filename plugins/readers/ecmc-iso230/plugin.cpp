// SPDX-License-Identifier: Apache-2.0
#include "ecmc_iso230.h"

NONIO_PLUGIN(registry) { registry.add(nonio::ecmc_iso230::reader()); }
