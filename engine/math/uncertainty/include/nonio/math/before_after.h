// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "nonio/math/budget.h"

/// Tests the effect of a compensation: one line is measured before and after, at the same stops.
///
/// b_i, a_i: means before and after, each relative to its first stop. A table that compensates the
/// errors leaves a = f b with f = 0; one that is not active f = 1; one with the wrong sign f = 2.
/// The table was made from b, so the measuring error of b is in the machine afterwards: a = E + (f
/// - 1) b with b = E + n_b, and the rest r = a - f b = n_a - n_b has one covariance V for every f,
/// from all readings and inputs:
///
///     chi2 = r' V^-1 r, F = chi2/m with m and nu degrees of freedom
///     f by generalized least squares: b' V^-1 a/(b' V^-1 b), u^2 = 1/(b' V^-1 b)
///
/// A table has entries with a step q at points of its own, and is linear between them. If a stop is
/// between two points at a distance h, the table misses the corner of b there by
///
///     theta_i k_i,   k_i = (s_right - s_left) h/4,   0 <= theta_i <= 1
///
/// with the slopes s of b on both sides of the stop. No table is coarser than the smallest distance
/// of the stops, which is used for h. The second moment of a uniform theta_i is 1/3; it is the same
/// for all stops or independent for each, so both cases are added. For f = 0 and 2, where a table
/// is active, the covariance is V + W with
///
///     W = J [diag(k^2/3 + q^2/12) + k k'/3] J'     J: each stop minus the first one
///
/// If the table was made from other readings b0 = E + n_0, f = 2 leaves r = n_a + n_0 - 2 n_b: the
/// larger p of both cases is used.
///
/// If f = 0 fits, f is estimated with V + W as well, and the table has worked only if f + 2 u < 1/2:
/// a coarse table may fit a = 0 stop by stop while it corrects half of the errors. Derived.
namespace nonio::math {

struct BeforeAfter {
  enum class Answer { worked, half_left, not_active, wrong_sign, something_else, cannot_tell };
  Answer answer = Answer::cannot_tell;
  std::array<double, 3> p{};  ///< p-values of f = 0, 1, 2
  double f = 0.0, u_f = 0.0;
  /// for f = 0, at every stop: predicted value, difference r from it, u of r; 0 at the first stop
  std::vector<double> predicted, rest, u;
  std::size_t worst = 0;  ///< index of the stop with the largest ratio of abs(r) to its u
};

/// `model`: the line before and then the line after, with one reading for each mean. `dof`: degrees
/// of freedom of the repetition. `entry_step`: q; 0 if the control is not known. `cannot_tell`:
/// several values of f fit, because the errors before compensation are too small.
BeforeAfter before_after(std::span<const double> before, std::span<const double> after,
                         const ReadingModel& model, double dof, double entry_step = 0.0);

}  // namespace nonio::math
