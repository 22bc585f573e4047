// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::heidenhain_tnc {

/// Writes the .COM table under the name that CONFIG.CMA assigns to the axis. An empty cell of
/// CONFIG.CMA is filled.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::heidenhain_tnc
