// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "nonio/math/axis_test.h"

/// Drift of the readings over the runs of a test.
///
///     o_p, q_p offset and slope of pass p (m or rad; m/m): of its readings minus the mean of their
///              target and direction
///     per run  slope of one line over the run number through the passes of both directions
///     lag_i    time of target i in + minus that in -, in runs: the passes of a run follow one
///              another, + upwards and - downwards
///     b_i      (offset per run + slope per run (x_i - middle)) lag_i: contribution of drift to B_i
///
/// Source: derived (docs/dev/estimators.md). `known` is false if no direction has two passes, or
/// with fewer than two targets (four for the slope).
namespace nonio::math {

struct Drift {
  struct Part {
    bool known = false;
    double per_run = 0.0, total = 0.0;  ///< change per run; total: from the first run to the last
    double u = 0.0;  ///< standard uncertainty of per_run, from readings or passes: the larger one
    double p_scatter = 1.0;  ///< p-value of per_run, from the scatter within the passes
    double p_passes = 1.0;   ///< p-value of the slope of the line through the single passes
    double p_runs = 1.0;     ///< p-value of the slope through the runs; 1 for fewer than three runs
    bool monotone = false;
    bool agree = true;  ///< false if the drifts of the two directions have opposite signs
  };
  Part offset, slope;
  double scatter = 0.0;  ///< standard deviation of a reading within its pass
  double middle = 0.0;   ///< position to which the offset of a pass refers
  std::size_t runs = 0;
  std::vector<double> lag;  ///< lag_i of each target, in runs; empty if measured from one direction

  double in_B_mean = 0.0;  ///< mean of b_i over the targets: contribution of drift to B_mean

  /// Fraction of the variation of the reversal along the axis predicted by b_i that is observed,
  /// and p-value of the test that this fraction is 0.
  double seen_in_reversal = 0.0, p_reversal = 1.0;

  double per_run_at(double x) const { return offset.per_run + slope.per_run * (x - middle); }
  double u_at(double x) const;
};
Drift estimate_drift(const AxisTest&);

/// Contributions of drift and repetition to the results of a test that the readings do not exclude;
/// expanded, m or rad. Results are not corrected for drift, so it is included in full.
struct DriftShare {
  double B = 0.0;  ///< contribution to the largest reversal B_i
  double B_mean = 0.0;
  double s = 0.0;  ///< contribution to the largest standard deviation of a target and direction
};
DriftShare drift_share(const AxisTest&);

}  // namespace nonio::math
