// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::aerotech {

/// Replaces the tables of one axis (:START n ... :END) in a backup; other axes and planes are kept.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::aerotech
