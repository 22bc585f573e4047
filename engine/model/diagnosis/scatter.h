// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "nonio/model/comparison.h"

/// Tests of the scatter of the residuals of an explanation that no effect can cause.
namespace nonio::model {

/// Whether the readings at single targets fall into two groups with a gap between them, which noise
/// does not cause. Groups less than 1.6 `digit` apart are ignored, because the rounding of the
/// display causes them. False for fewer than 40 readings.
bool two_valued(const Repeats& repeats, const std::vector<double>& residual,
                const std::vector<double>& weight, double digit);

/// Tests whether targets differ by more than their two sides do, for targets read once from each of
/// two sides, of which one reading may be an outlier: the most favorable target is omitted. Returns
/// the place "position", with p corrected for the choice of the omitted target.
std::optional<Place> next_to_a_misread_target(const Observations& o, const Repeats& repeats,
                                              const std::vector<double>& residual,
                                              const std::vector<double>& weight);

/// Returns the run whose scatter differs most from that of the others, if it is significant.
std::optional<Place> wild_run(const Observations& o, const Repeats& repeats,
                              const std::vector<double>& residual,
                              const std::vector<double>& weight, const Noise& noise);

}  // namespace nonio::model
