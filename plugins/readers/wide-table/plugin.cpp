// SPDX-License-Identifier: Apache-2.0
#include "wide_table.h"

NONIO_PLUGIN(registry) { registry.add(nonio::wide_table::reader()); }
