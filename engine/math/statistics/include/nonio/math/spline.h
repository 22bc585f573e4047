// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::math {

/// Returns the values at `x` of a basis of `knots` smooth functions without constant and slope, one
/// vector for each function. They represent the remainder of a straight-line fit (pitch curve,
/// straightness).
///
/// Cubic splines on `knots` equally spaced knots, the first and the last at the ends of `targets`,
/// have knots + 2 free values; removing constant and slope leaves `knots`. Over the targets (each
/// once, ascending) the functions sum to zero, are orthogonal to x and to each other and have an
/// rms of 1: the rms of a curve is the root of the sum of squares of its coefficients. Outside of
/// the targets the last polynomial continues.
///
/// Error: fewer than 2 knots, or targets that do not determine every function (a gap over several
/// knots). Source: de Boor, A Practical Guide to Splines (2001), IX (B-splines), XIII
/// (Schoenberg-Whitney).
Expected<std::vector<std::vector<double>>> smooth_basis(const std::vector<double>& x,
                                                        const std::vector<double>& targets,
                                                        int knots);

}  // namespace nonio::math
