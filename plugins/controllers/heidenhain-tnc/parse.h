// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio::heidenhain_tnc {

/// Follows the manual of the control, independently of the code that writes the files, so that it
/// verifies them.
Expected<std::vector<LoadedTable>> parse(const TableInput&);

}  // namespace nonio::heidenhain_tnc
