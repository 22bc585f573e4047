// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::siemens_840d {

/// The axis' lines in archives that hold several; direction tables get the numbers that the axis
/// has, or free ones.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::siemens_840d
