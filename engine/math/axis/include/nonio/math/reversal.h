// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/axis_test.h"

namespace nonio::math {

/// Classification of the reversal error of an axis by statistical tests.
///
///     B_i = xm_i+ - xm_i-                               m or rad; B_mean over the m targets
///     F   = [sum (B_i - B_mean)^2/(m - 1)] / [s+^2/n+ + s-^2/n-]    tests whether B_i varies
///     t   = B_mean/u(B_mean)                            tests whether B_mean differs from 0
///
/// Both tests use the 1 % level. u comes from the differences between runs, pooled with the scatter
/// of single readings unless the runs scatter more (T. A. Bancroft, Biometrics 20 (1964) 427). The
/// decisions are a laboratory method (docs/dev/estimators.md; docs/dev/constants.md, A3 to A5).
struct Reversal {
  enum class Kind {
    unknown,      ///< a target lacks one direction, or one run does not allow a decision
    none,         ///< not distinguishable from zero
    lost_motion,  ///< negative, and constant or at least halved by compensation with one value
    /// positive, and constant or at least halved by one value, whatever the cause
    over_compensated,
    not_constant,  ///< not constant, and not even halved by compensation with one value
  };
  Kind kind = Kind::unknown;
  double mean = 0.0;  ///< B_mean, m or rad, signed
  /// u of `mean` from the scatter of the readings; with one run an upper bound from that of B_i
  double u_mean = 0.0;
  double largest = 0.0;       ///< largest reversal, max |B_i|
  double largest_left = 0.0;  ///< max |B_i - B_mean|: remains after compensation by a single value
  double p_varies = 1.0;
  double p_mean = 1.0;

  /// Sinusoids over the angle of a rotary axis. The amplitudes are NaN for a linear axis, or if the
  /// targets do not cover the turn.
  double opposed_amplitude = 0.0;  ///< amplitude of B_i / 2 over the angle: elasticity
  double p_opposed = 1.0;
  double concordant_amplitude = 0.0;  ///< amplitude common to both directions: eccentricity
  double p_concordant = 1.0;
  bool opposed = false, concordant = false;
};

/// Without both directions at every target, `kind` is unknown, and `mean`, `u_mean`, `largest` and
/// `largest_left` are NaN. Sinusoids need 5 angles and no gap above 120 deg.
Reversal assess_reversal(const AxisTest& test);

}  // namespace nonio::math
