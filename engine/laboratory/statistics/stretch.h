// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

/// Restricts fitted curves to the stretch of an axis that the targets of two campaigns have in
/// common, so that the curves can be compared. The caller must have checked the sizes; no function
/// returns an error.
namespace nonio::statistics {

struct Stretch {
  double from = 0.0, to = 0.0;

  double length() const { return to - from; }
};

/// Returns the stretch that both cover; its length is 0 if they do not overlap.
Stretch common_stretch(const Stretch&, const Stretch&);

/// A fitted curve: coefficients of Legendre polynomials P0 .. Pd, with argument -1 at the beginning
/// of the stretch and 1 at its end.
struct FittedCurve {
  Stretch over;
  std::vector<double> coefficients;
  /// Matrices of the coefficients, row by row: covariance from the readings, and covariance that
  /// independent values of variance 1 at the targets would give.
  std::vector<double> covariance, share;
};

/// A coefficient of the same curve over another stretch, with its variance from the readings and
/// from independent values of variance 1 at the targets.
struct CoefficientOver {
  double value = 0.0, variance = 0.0, share = 0.0;
};

/// Returns the coefficient of P_degree of the same curve when it is written as Legendre polynomials
/// over `other`. The conversion is exact. `degree`: not above that of the curve.
CoefficientOver coefficient_over(const FittedCurve&, const Stretch& other, std::size_t degree);

}  // namespace nonio::statistics
