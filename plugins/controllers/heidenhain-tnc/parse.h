// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio::heidenhain_tnc {

/// The control as the manual describes it: what it does with these files. Shares nothing with the
/// code that writes them.
Expected<std::vector<LoadedTable>> parse(const TableInput&);

}  // namespace nonio::heidenhain_tnc
