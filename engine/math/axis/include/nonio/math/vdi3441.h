// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/math/axis_test.h"

namespace nonio::math {

enum class StandardDeviation { direct, from_range };

/// VDI/DGQ 3441 at one target; m or rad, NaN where the readings do not give the value.
struct VdiPoint {
  double target;
  double mean;  ///< xs_j, of both directions
  double S_plus, S_minus;
  double S;   ///< (S+ + S-)/2
  double U;   ///< |xm+ - xm-|
  double Ps;  ///< 6 S
};

struct VdiResult {
  std::vector<VdiPoint> points;
  double P, Pa, Ps_max, Ps_mean, U_max, U_mean;
  double PsU_max;  ///< max(U_j + Ps_j)
  double P_plus, P_minus, Pa_plus, Pa_minus, Ps_max_plus, Ps_max_minus;
};

/// VDI/DGQ 3441:1977. A value is NaN unless every target gives its part. `from_range` divides the
/// range by d_n (n = 2..10; more readings or one give NaN).
VdiResult evaluate_vdi3441(const AxisTest& test, StandardDeviation how);

}  // namespace nonio::math
