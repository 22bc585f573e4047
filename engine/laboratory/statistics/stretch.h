// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

/// Curves of campaigns whose targets cover different stretches of an axis, compared over the stretch
/// that they have in common. No error: who calls them has checked the sizes.
namespace nonio::statistics {

struct Stretch {
  double from = 0.0, to = 0.0;

  double length() const { return to - from; }
};

/// What both cover; of no length if they do not overlap.
Stretch common_stretch(const Stretch&, const Stretch&);

/// Coefficients of Legendre polynomials P0 .. Pd, -1 at the beginning of a stretch and 1 at its end.
struct FittedCurve {
  Stretch over;
  std::vector<double> coefficients;
  /// Between them, row by row: what the readings make, and what independent values of variance 1 at
  /// the targets make.
  std::vector<double> covariance, share;
};

/// A coefficient of the same curve over another stretch, and the two variances of it.
struct CoefficientOver {
  double value = 0.0, variance = 0.0, share = 0.0;
};

/// Exact for the polynomial: its part along P_degree over the other stretch, which is what a fit
/// with the lower and higher polynomials there gives. degree: not above that of the curve.
CoefficientOver coefficient_over(const FittedCurve&, const Stretch& other, std::size_t degree);

}  // namespace nonio::statistics
