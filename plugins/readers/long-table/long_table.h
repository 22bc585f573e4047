// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::long_table {

/// A row for each target, a column for each run and direction, as the user maps them.
Reader reader();

}  // namespace nonio::long_table
