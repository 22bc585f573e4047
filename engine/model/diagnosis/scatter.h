// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "nonio/model/comparison.h"

namespace nonio::model {

/// Whether the readings at single targets fall into two groups with a gap that noise does not
/// cause. Groups less than 1.6 `digit` apart are due to rounding. False for fewer than 40 readings,
/// and if repeats are in different groups more often than independent readings would be.
bool two_valued(const Repeats& repeats, const std::vector<double>& residual,
                const std::vector<double>& weight, double digit);

/// Tests whether targets differ by more than their two sides do, without the most favorable target,
/// because one reading may be an outlier; p is corrected for this choice. std::nullopt unless at
/// least five targets of one axis were read once from each of two sides.
std::optional<Place> next_to_a_misread_target(const Observations& o, const Repeats& repeats,
                                              const std::vector<double>& residual,
                                              const std::vector<double>& weight);

/// The run with the most significantly larger scatter, by a factor of at least two. Runs with fewer
/// than six repeated readings are not tested.
std::optional<Place> wild_run(const Observations& o, const Repeats& repeats,
                              const std::vector<double>& residual,
                              const std::vector<double>& weight, const Noise& noise);

/// Number of cells with readings, minus the terms that the passes of each side share.
double degrees_of_cells(const Repeats& repeats, const std::vector<double>& weight);

}  // namespace nonio::model
