// SPDX-License-Identifier: Apache-2.0
#include "long_table.h"

namespace nonio::long_table {

NONIO_PLUGIN(registry) { registry.add(long_table::reader()); }

}  // namespace nonio::long_table
