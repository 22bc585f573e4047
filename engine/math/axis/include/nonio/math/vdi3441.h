// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/math/axis_statistics.h"

namespace nonio::math {

/// Estimator of the standard deviation. direct: S = sqrt(sum (x - xm)^2/(n - 1)). from_range: S =
/// (max x - min x)/d_n, with d_n the mean range of n standard normal values (L. H. C. Tippett,
/// Biometrika 17 (1925) 364).
enum class StandardDeviation { direct, from_range };

/// Values of VDI/DGQ 3441 at one target; m or rad, NaN if the readings do not determine the value.
struct VdiPoint {
  double target;
  double mean;  ///< xs_j, mean of both directions
  double S_plus, S_minus;
  double S;   ///< mean of both directions, (S+ + S-)/2
  double U;   ///< reversal span, |xm+ - xm-|
  double Ps;  ///< position scatter, 6 S
};

/// Values of VDI/DGQ 3441 for the axis, m or rad; max and min over the targets j:
///
///     P    max(xs_j + (U_j + Ps_j)/2) - min(xs_j - (U_j + Ps_j)/2)
///     Pa   max xs_j - min xs_j                               M of ISO 230-2
///     P+   max(xm_j+ + 3 S_j+) - min(xm_j+ - 3 S_j+)             P- in the same way
///     Pa+  max xm_j+ - min xm_j+                                     Pa- in the same way
struct VdiResult {
  std::vector<VdiPoint> points;
  double P, Pa, Ps_max, Ps_mean, U_max, U_mean;
  double PsU_max;  ///< largest sum of reversal span and scatter, max(U_j + Ps_j)
  double P_plus, P_minus, Pa_plus, Pa_minus, Ps_max_plus, Ps_max_minus;
};

/// A value is NaN unless every target contributes to it; a value of one direction needs only the
/// targets approached in it. `from_range` needs n = 2..10, otherwise the value is NaN. Source:
/// VDI/DGQ 3441:1977 with confidence M (docs/formulas.md), because its text was not available.
VdiResult evaluate_vdi3441(const AxisTest& test, StandardDeviation how);
VdiResult evaluate_vdi3441(const AxisStatistics&, StandardDeviation how);

}  // namespace nonio::math
