// SPDX-License-Identifier: Apache-2.0
#include "long_table.h"

NONIO_PLUGIN(registry) { registry.add(nonio::long_table::reader()); }
