// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "nonio/model/comparison.h"

/// How the residuals of an explanation scatter: parts that no effect causes.
namespace nonio::model {

/// Repeats of one target fall into two groups with nothing between them: no noise does that.
/// Neighbouring digits of a display are none.
bool two_valued(const Repeats& repeats, const std::vector<double>& residual,
                const std::vector<double>& weight, double digit);

/// Each target read once from each of two sides, and one reading may be misread: whether targets
/// differ by more than their two sides do, with the best of them left out. Place "position", p
/// corrected for which is left out.
std::optional<Place> next_to_a_misread_target(const Observations& o, const Repeats& repeats,
                                              const std::vector<double>& residual,
                                              const std::vector<double>& weight);

/// One run with a scatter of its own.
std::optional<Place> wild_run(const Observations& o, const Repeats& repeats,
                              const std::vector<double>& residual,
                              const std::vector<double>& weight, const Noise& noise);

}  // namespace nonio::model
