// SPDX-License-Identifier: Apache-2.0
#include "wide_table.h"

namespace nonio::wide_table {

NONIO_PLUGIN(registry) { registry.add(wide_table::reader()); }

}  // namespace nonio::wide_table
