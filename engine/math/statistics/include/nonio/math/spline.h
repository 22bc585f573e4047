// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::math {

/// Returns the values at `x` of `knots` smooth functions, one vector each: cubic splines on equally
/// spaced knots, the first and the last at the ends of `targets`, without constant and slope. Over
/// the targets (each once, ascending) the functions sum to zero, are orthogonal to x and to each
/// other, and have an rms of 1. Outside of the targets the last polynomial continues. Error: fewer
/// than 2 knots, or targets that do not determine every function. Source: de Boor, A Practical
/// Guide to Splines (2001), IX (B-splines), XIII (Schoenberg-Whitney).
Expected<std::vector<std::vector<double>>> smooth_basis(const std::vector<double>& x,
                                                        const std::vector<double>& targets,
                                                        int knots);

}  // namespace nonio::math
