// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/math/axis_statistics.h"

namespace nonio::math {

/// Values of ISO 230-2 at one target. m or rad; NaN if the readings do not determine the value.
struct Iso230Point {
  double target;
  std::size_t n_plus, n_minus;
  double mean_plus, mean_minus;
  double mean;
  double B;  ///< reversal, B_i = xm_i+ - xm_i-
  double s_plus, s_minus;
  double R_plus, R_minus, R;  ///< repeatability: 2 k s; R_i = max(k s+ + k s- + |B_i|, R_i+, R_i-)
};

/// Values of ISO 230-2 for the axis, m or rad; max and min over the targets:
///
///     A   max(xm_i+ + k s_i+; xm_i- + k s_i-) - min(xm_i+ - k s_i+; xm_i- - k s_i-)
///     E   max(xm_i+; xm_i-) - min(xm_i+; xm_i-)     M   max xm_i - min xm_i
///     R   max R_i                                   R+  max R_i+
///     A+, E+, R+ (and -): the same from the readings of one direction
///
/// A value is NaN unless every target contributes to it; A+, E+ and R+ need only the targets
/// approached in direction +, and likewise for -.
struct Iso230Result {
  double k;  ///< coverage factor of R and A
  std::vector<Iso230Point> points;
  double A, A_plus, A_minus;
  double E, E_plus, E_minus;
  double M;
  double R, R_plus, R_minus;
  double B;       ///< largest reversal, max |B_i|
  double B_mean;  ///< mean of B_i, signed
};

/// k = 3 for the edition of 1988 (from its forms 6 s and 3 s), 2 for those of 1997, 2006 and 2014.
/// R and A need two readings of each direction at every target. Source: ISO 230-2:2014 clause 2.
Iso230Result evaluate_iso230_2(const AxisTest& test, double k);
Iso230Result evaluate_iso230_2(const AxisStatistics&, double k);

}  // namespace nonio::math
