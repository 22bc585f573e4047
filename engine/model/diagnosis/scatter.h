// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "nonio/model/comparison.h"

/// Tests of residuals of a model for kinds of scatter that no effect of the model can cause.
namespace nonio::model {

/// Returns whether the readings at single targets fall into two groups with a gap between them,
/// which noise does not cause. Groups less than 1.6 `digit` apart are ignored, because the rounding
/// of the display causes them. False for fewer than 40 readings, and if repeats are in different
/// groups more often than independent readings would be.
bool two_valued(const Repeats& repeats, const std::vector<double>& residual,
                const std::vector<double>& weight, double digit);

/// Tests whether targets differ by more than their two sides do, for at least five targets of one
/// axis, read once from each of two sides, of which one reading may be an outlier: the most
/// favorable target is omitted. Returns the place "position", with p corrected for the choice of
/// the omitted target; none for other readings.
std::optional<Place> next_to_a_misread_target(const Observations& o, const Repeats& repeats,
                                              const std::vector<double>& residual,
                                              const std::vector<double>& weight);

/// Returns the run whose scatter is most significantly larger than that of the others, at least by
/// a factor of two; none if there is no such run. Runs with fewer than six repeated readings are
/// not tested.
std::optional<Place> wild_run(const Observations& o, const Repeats& repeats,
                              const std::vector<double>& residual,
                              const std::vector<double>& weight, const Noise& noise);

}  // namespace nonio::model
