// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "nonio/sdk/error.h"

/// Straightness of a line of motion from deviations e_i across it (m) at positions x_i (m).
///
///     reference line   r(x) = a + b (x - x_1)
///     rest             d_i = e_i - r(x_i)
///     straightness     W = max d_i - min d_i
///
/// Reference lines of ISO 230-1:2012, 3.4: mean minimum zone (smallest W), least squares (smallest
/// sum d_i^2), end points. The minimum zone is the best approximation in the sense of Chebyshev:
/// three points have the largest distance, on alternate sides. The text of the standard was not
/// available (docs/formulas.md).
namespace nonio::math {

enum class StraightLine { least_squares, minimum_zone, end_points };

struct Straightness {
  double a = 0.0;  ///< reference line at the first point, m
  double b = 0.0;  ///< slope of the reference line, rad
  std::vector<double> rest;
  double width = 0.0;
  /// Derivatives dW/de_i and db/de_i, valid as long as the same points determine W and b.
  std::vector<double> width_by, slope_by;
};

/// `x` and `e` in m. Errors: fewer than three positions, another number of deviations, positions
/// that do not ascend, values that are not finite.
Expected<Straightness> straightness_about(StraightLine, std::span<const double> x,
                                          std::span<const double> e);

/// Integrates the angles of a level or autocollimator on a base of length `foot`, m, that is moved
/// by its own length along the line: e_0 = 0, e_(k+1) = e_k + foot * angle_k (rad). Returns one
/// more value than angles, m. Source: ISO 230-1 (measurement of straightness by angles).
std::vector<double> integrated(std::span<const double> angles, double foot);

}  // namespace nonio::math
