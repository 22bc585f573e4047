// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::fanuc {

/// The axis' parameters and numbers in a punched backup; numbers of other axes are never taken.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::fanuc
