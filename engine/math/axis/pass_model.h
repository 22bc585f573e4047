// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nonio/math/axis_test.h"

namespace nonio::math {

/// Fit of passes. A pass is all readings of one run in one direction. The model of a reading is
///     x = mean of its target and direction + offset of its pass (+ slope of its pass * z) + e
/// with z the distance of the target from the middle of the targets. The scatter of 5 passes has 4
/// degrees of freedom, however many targets a pass has.
struct PassModel {
  struct Pass {
    std::uint32_t run;
    bool minus;
    std::size_t readings = 0;
    double offset = 0.0;  ///< m or rad; its mean over the passes of a direction is 0
    double slope = 0.0;   ///< m/m or rad/rad; its mean over the passes of a direction is 0
  };
  struct Side {            // side[0]: direction +; side[1]: direction -
    double squares = 0.0;  ///< sum of squared residuals e^2
    double dof = 0.0;      ///< degrees of freedom; 0 or less if the readings give no scatter
    std::size_t passes = 0;
    std::size_t targets = 0;
    std::size_t readings = 0;
    double variance() const { return squares / dof; }
  };
  std::vector<Pass> passes;  ///< sorted by run, direction + before -
  std::vector<std::uint32_t> pass;
  std::vector<std::uint32_t> target;
  std::vector<double> e;  ///< residual of each reading; NaN for omitted readings
  Side side[2];
  double middle = 0.0;  ///< position with z = 0, m or rad
};

/// Fits by least squares, alternating between targets and passes; for equal runs one round is
/// exact. With `slopes`, passes with three or more readings also have a slope. `left_out`: indices
/// of readings that are omitted.
PassModel fit_passes(const AxisTest& test, bool slopes, std::span<const std::size_t> left_out = {});

/// Returns the index, in `readings()`, of the first reading of target i in one direction.
std::size_t first_reading(const AxisTest& test, std::size_t i, bool minus);

/// Returns the effective degrees of freedom of a + b, the sum of two estimated variances with dof_a
/// and dof_b degrees of freedom (Welch-Satterthwaite); dof_a + dof_b if the sum is 0.
double joined_dof(double a, double dof_a, double b, double dof_b);

}  // namespace nonio::math
