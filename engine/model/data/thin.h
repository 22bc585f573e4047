// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Longer tables are searched, and their positions described, from means of their readings.
inline constexpr std::size_t thin_beyond = 6000;

/// Means of readings that lie close together: of one line and direction, of neighbouring runs and
/// neighbouring positions, as many as stay below `thin_beyond` rows where that leaves 2 runs and 25
/// positions. Readings of weight 0 are left out. The noise of a mean is smaller; what varies slowly
/// stays.
Observations thinned(const Observations& o, const std::vector<double>& weight);
Part thinned(const Part& part, const std::vector<double>& weight);

/// Only tables of one axis can: the readings of several seldom lie close together.
bool can_be_thinned(const Observations& o);

}  // namespace nonio::model
