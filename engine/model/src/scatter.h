// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"
#include "repeats.h"

/// How what an explanation leaves scatters: what no effect can be blamed for, or named beside.
namespace nonio::model {

/// Repeats of one target fall into two groups with nothing between them: no noise does that.
bool two_valued(const Repeats& repeats, const std::vector<double>& residual,
                const std::vector<double>& weight);

/// One run with a scatter of its own.
std::optional<Place> wild_run(const Observations& o, const Repeats& repeats,
                              const std::vector<double>& residual,
                              const std::vector<double>& weight);

/// A zero that walks: what repeats leave has a memory from one reading of a pass to the next. Its
/// size is that of a random walk over all passes: step^2 n/6 in square, of which a pass of m
/// readings keeps step^2 3m/70 when its curve of second degree is taken out.
std::optional<Place> walking_zero(const Repeats& repeats, const std::vector<double>& residual,
                                  const std::vector<double>& weight);

}  // namespace nonio::model
