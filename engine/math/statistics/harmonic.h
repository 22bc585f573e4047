// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace nonio::math {

/// One sinusoid per turn, fitted by least squares: y = c + a cos(angle) + b sin(angle).
struct Harmonic {
  bool known = false;      ///< false if the angles do not cover the turn or a value is not finite
  double amplitude = 0.0;  ///< sqrt(a^2 + b^2), in the unit of y
  double share = 0.0;      ///< fraction of the variance of y explained by the sinusoid, 0..1
  double p = 1.0;
};

/// `angle` in rad. The turn is covered by 5 different angles without a gap above 120 deg.
Harmonic fit_harmonic(std::span<const double> angle, std::span<const double> y);

}  // namespace nonio::math
