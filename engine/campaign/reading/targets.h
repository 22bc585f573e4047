// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/observations.h"

namespace nonio::reading {

/// Makes positions of an axis that lie within `grid_tolerance` of one another one position: the one
/// that most readings have. The last digits of what a file computed or rounded would otherwise make
/// two targets of one, each with too few readings. Returns how many positions were moved.
std::size_t join_targets(Observations& o);

}  // namespace nonio::reading
