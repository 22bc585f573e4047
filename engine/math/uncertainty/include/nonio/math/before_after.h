// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "nonio/math/budget.h"

/// Whether a compensation did what it should: one line before and after, at the same stops.
///
/// b_i, a_i: means before and after, each from its first stop on. A table that takes the errors away
/// leaves a = f b with f = 0; one that is not active f = 1; one with the wrong sign f = 2. The table
/// was made from b, so the error of b is in the machine afterwards: a = E + (f - 1) b with b = E +
/// n_b, and the rest r = a - f b = n_a - n_b has one covariance V for every f, of all readings and
/// inputs:
///
///     chi2 = r' V^-1 r, F = chi2/m with m and nu degrees of freedom
///     f by generalised least squares: b' V^-1 a/(b' V^-1 b), u^2 = 1/(b' V^-1 b)
///
/// Derived; tests hold it against simulated campaigns.
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
/// repetition. `cannot_tell` where before is too small to tell the answers apart.
BeforeAfter before_after(std::span<const double> before, std::span<const double> after,
                         const ReadingModel& model, double dof);

}  // namespace nonio::math
