// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "nonio/math/budget.h"

/// Whether a compensation did what it should: one line before and after, at the same stops.
///
/// b_i, a_i: means before and after, each from its first stop on. A table that compensates the
/// errors leaves a = f b with f = 0; one that is not active f = 1; one with the wrong sign f = 2.
/// The table was made from b, so the error of b is in the machine afterwards: a = E + (f - 1) b
/// with b = E + n_b, and the rest r = a - f b = n_a - n_b has one covariance V for every f, of all
/// readings and inputs:
///
///     chi2 = r' V^-1 r, F = chi2/m with m and nu degrees of freedom
///     f by generalised least squares: b' V^-1 a/(b' V^-1 b), u^2 = 1/(b' V^-1 b)
///
/// A table is not b itself. It has entries of a step q at points of its own, and is linear between
/// them; outside it holds its last value. Where a stop is between two points that are h apart, the
/// table passes the corner of b there at a distance of
///
///     theta_i k_i,   k_i = (s_right - s_left) h/4,   0 <= theta_i = 4 t (1 - t) <= 1
///
/// s: slopes of b on both sides of the stop; t: its place between the points. h is not known, but
/// no table is coarser than the smallest distance of the stops. theta_i is not known either: its
/// second moment, if uniform, is 1/3, and it is one for all stops (even steps) or one for each, so
/// both are added. Rounding is rectangular, q^2/12. For f = 0 and 2, where a table is active, V is
/// therefore V + W with
///
///     W = J [diag(k^2/3 + q^2/12) + k k'/3] J'     J: each stop less the first one
///
/// Where the table was made from other readings b0 = E + n_0, f = 2 leaves r = n_a + n_0 - 2 n_b:
/// the larger one of both p counts. For f = 0 it is n_a - n_0, which has the covariance V too.
///
/// Derived; tests compare it with simulated campaigns.
namespace nonio::math {

struct BeforeAfter {
  enum class Answer { worked, not_active, wrong_sign, something_else, cannot_tell };
  Answer answer = Answer::cannot_tell;
  std::array<double, 3> p{};  ///< of f = 0, 1, 2
  double f = 0.0, u_f = 0.0;
  std::vector<double> predicted, rest, u;  ///< of f = 0 at every stop; the first one 0
  std::size_t worst = 0;                   ///< stop with the largest rest in terms of its u
};

/// The model has the line before and then the one after, a reading for each mean. dof: of the
/// repetition. entry_step: q, 0 where the control is not known. `cannot_tell`: the errors before
/// are too small to decide.
BeforeAfter before_after(std::span<const double> before, std::span<const double> after,
                         const ReadingModel& model, double dof, double entry_step = 0.0);

}  // namespace nonio::math
