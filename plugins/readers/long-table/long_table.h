// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::long_table {

/// Reads tables with one row per reading; the user maps the columns.
Reader reader();

}  // namespace nonio::long_table
