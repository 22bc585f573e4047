// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Readings above which means (`thinned`) replace them in the search and in the tests of places.
inline constexpr std::size_t thin_beyond = 6000;

/// Means of readings of one line and direction, over adjacent runs and positions; at most
/// `thin_beyond` rows for up to 60 lines. Readings of weight 0 are omitted. Slow variations remain.
/// A table that cannot be thinned is returned unchanged.
Observations thinned(const Observations& o, const std::vector<double>& weight);
Part thinned(const Part& part, const std::vector<double>& weight);

/// True only for tables of one axis with directions of approach, because readings in space are
/// seldom close to each other.
bool can_be_thinned(const Observations& o);

}  // namespace nonio::model
