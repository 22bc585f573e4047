// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::fanuc {

/// Replaces parameters and point numbers of an axis in a punched backup; other axes keep their own.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::fanuc
