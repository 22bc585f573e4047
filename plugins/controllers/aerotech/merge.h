// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::aerotech {

/// The tables of one axis (:START n ... :END) in a backup; planes and those of other axes stay.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::aerotech
