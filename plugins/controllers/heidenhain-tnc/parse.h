// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio::heidenhain_tnc {

/// Parses the files as the manual describes the control. It is independent of the code that writes
/// the files, so that it can verify it.
Expected<std::vector<LoadedTable>> parse(const TableInput&);

}  // namespace nonio::heidenhain_tnc
