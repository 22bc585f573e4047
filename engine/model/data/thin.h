// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Number of readings above which means of readings (`thinned`) replace the readings of a table in
/// the search for effects and in the test that locates the residuals.
inline constexpr std::size_t thin_beyond = 6000;

/// Averages readings that are close together: of one line and direction, of adjacent runs and
/// adjacent positions, so that fewer than `thin_beyond` rows remain, but at least 2 runs and 25
/// positions. Readings of weight 0 are omitted. The noise of a mean is smaller; slow variations
/// remain.
Observations thinned(const Observations& o, const std::vector<double>& weight);
Part thinned(const Part& part, const std::vector<double>& weight);

/// Whether readings can be averaged: only in tables of one axis, because readings in space are
/// seldom close together.
bool can_be_thinned(const Observations& o);

}  // namespace nonio::model
