// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::heidenhain_tnc {

/// Writes the .COM table under the name that CONFIG.CMA assigns to the axis, and fills an empty
/// cell of CONFIG.CMA.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::heidenhain_tnc
