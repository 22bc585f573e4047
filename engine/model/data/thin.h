// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Number of readings above which means of readings (`thinned`) replace the readings of a table in
/// the search for effects and in the test that locates the residuals.
inline constexpr std::size_t thin_beyond = 6000;

/// Returns the means of readings that are close together: of one line and direction, of adjacent
/// runs and adjacent positions. At most `thin_beyond` rows remain if there are at most 60 lines.
/// Readings of weight 0 are omitted. The noise of a mean is smaller; slow variations remain. A
/// table that cannot be thinned is returned unchanged.
Observations thinned(const Observations& o, const std::vector<double>& weight);
Part thinned(const Part& part, const std::vector<double>& weight);

/// Returns whether readings can be averaged: only in tables of one axis that have a direction of
/// approach for each reading, because readings in space are seldom close together.
bool can_be_thinned(const Observations& o);

}  // namespace nonio::model
