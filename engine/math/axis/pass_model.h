// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nonio/math/axis_test.h"

namespace nonio::math {

/// A pass is all readings of one run in one direction. The model of a reading is
///     x = mean of its target and direction + offset of its pass (+ slope of its pass * z) + e
/// with z the distance of the target from the middle of the targets. What the readings of a pass
/// share (drift, a moved zero) is separated from the scatter of single readings: one scatter of 5
/// passes is known with 4 degrees of freedom, however many targets a pass has.
struct PassModel {
  struct Pass {
    std::uint32_t run;
    bool minus;
    std::size_t readings = 0;
    double offset = 0.0;  ///< m or rad; mean over the passes of a direction is 0
    double slope = 0.0;   ///< m/m or rad/rad; likewise
  };
  struct Side {               // [0] direction +, [1] direction -
    double squares = 0.0;     ///< sum of e^2
    double dof = 0.0;         ///< its degrees of freedom; <= 0 if no scatter is known
    std::size_t passes = 0;   ///< passes with readings
    std::size_t targets = 0;  ///< targets with readings
    std::size_t readings = 0;
    double variance() const { return squares / dof; }
  };
  std::vector<Pass> passes;           ///< by run, + before -
  std::vector<std::uint32_t> pass;    ///< of each reading, index into passes
  std::vector<std::uint32_t> target;  ///< of each reading, index into targets
  std::vector<double> e;              ///< of each reading; NaN for those left out
  Side side[2];
  double middle = 0.0;  ///< where z = 0, m or rad
};

/// Least squares, alternating between targets and passes (exact at once for equal runs).
/// `left_out`: readings, by index, that have no part in it.
PassModel fit_passes(const AxisTest& test, bool slopes, std::span<const std::size_t> left_out = {});

/// Index of the first reading of target i in direction + (minus = false) or -.
std::size_t first_reading(const AxisTest& test, std::size_t i, bool minus);

/// Degrees of freedom of a + b, both estimated variances (Welch, Satterthwaite).
double joined_dof(double a, double dof_a, double b, double dof_b);

}  // namespace nonio::math
