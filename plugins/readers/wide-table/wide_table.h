// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::wide_table {

/// Reads tables with one row per target and one column per run and direction; the user maps the
/// columns.
Reader reader();

}  // namespace nonio::wide_table
