// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::siemens_840d {

/// Replaces the lines of the axis in archives of several axes. Direction tables keep the numbers of
/// the backup, or get free ones.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::siemens_840d
