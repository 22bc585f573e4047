// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

/// Compares fitted curves over the stretch of an axis that two campaigns have in common. The caller
/// must check the sizes.
namespace nonio::statistics {

struct Stretch {
  double from = 0.0, to = 0.0;

  double length() const { return to - from; }
};

/// Returns the intersection; its length is 0 if the stretches do not overlap.
Stretch common_stretch(const Stretch&, const Stretch&);

/// Coefficients of Legendre polynomials P0 .. Pd, whose argument is -1 at the beginning of the
/// stretch and 1 at its end.
struct FittedCurve {
  Stretch over;
  std::vector<double> coefficients;
  /// Matrices of the coefficients, row by row: covariance from the readings, and covariance for
  /// independent values of variance 1 at the targets.
  std::vector<double> covariance, share;
};

/// A coefficient over another stretch, with its variance from the readings and for independent
/// values of variance 1 at the targets.
struct CoefficientOver {
  double value = 0.0, variance = 0.0, share = 0.0;
};

/// Converts the curve exactly to Legendre polynomials over `other` and returns the coefficient of
/// P_degree. `degree` must not exceed that of the curve.
CoefficientOver coefficient_over(const FittedCurve&, const Stretch& other, std::size_t degree);

}  // namespace nonio::statistics
