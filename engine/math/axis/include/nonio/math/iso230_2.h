// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/math/axis_statistics.h"

namespace nonio::math {

/// Values of ISO 230-2 at one target. m or rad; NaN if the readings do not determine the value.
struct Iso230Point {
  double target;
  std::size_t n_plus, n_minus;
  double mean_plus, mean_minus;  ///< mean of each direction, xm_i+, xm_i-
  double mean;                   ///< mean of both directions, xm_i = (xm_i+ + xm_i-)/2
  double B;                      ///< reversal, B_i = xm_i+ - xm_i-
  double s_plus, s_minus;        ///< estimated standard deviations, divisor n - 1
  double R_plus, R_minus, R;  ///< repeatability: 2 k s; R_i = max(k s+ + k s- + |B_i|, R_i+, R_i-)
};

/// Values of ISO 230-2 for the axis, m or rad; max and min over the targets:
///
///     A   max(xm_i+ + k s_i+; xm_i- + k s_i-) - min(xm_i+ - k s_i+; xm_i- - k s_i-)
///     E   max(xm_i+; xm_i-) - min(xm_i+; xm_i-)     M   max xm_i - min xm_i
///     R   max R_i                                   R+  max R_i+
///     A+, E+, R+ (and -): the same from the readings of one direction
///
/// A value is NaN unless every target contributes to it, so that no printed range covers less than
/// the whole axis; A+, E+ and R+ need only the targets approached in direction +, and likewise for
/// -.
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

/// Computes the values of ISO 230-2. Range: any test, k > 0. No errors: values that the readings do
/// not determine are NaN (s, and with it R and A, need two readings of each direction at every
/// target). k = 3 for the edition of 1988, 2 for those of 1997, 2006 and 2014. Source: ISO
/// 230-2:2014 clause 2 (symbols), k of 1988 from its forms 6 s and 3 s.
Iso230Result evaluate_iso230_2(const AxisTest& test, double k);
Iso230Result evaluate_iso230_2(const AxisStatistics&, double k);

}  // namespace nonio::math
