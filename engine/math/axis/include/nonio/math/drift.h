// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "nonio/math/axis_test.h"

/// Drift of the readings over a test, from two passes of a direction on.
///
///     o_p, q_p    offset and slope of pass p (m or rad; m/m): its readings less the mean of their
///                 target and direction
///     per run     one line over the run number through the passes of both directions
///     lag_i       time of target i in + less that in -, in runs: the passes of a run follow one
///                 another, + upwards and - downwards
///     b_i         (offset per run + slope per run (x_i - middle)) lag_i: what the drift adds to B_i
///
/// Source: derived (docs/formulas.md). Range: any test; `known` is false where no direction has two
/// passes. No errors.
namespace nonio::math {

struct Drift {
  struct Part {
    bool known = false;
    double per_run = 0.0, total = 0.0;  ///< total: from the first run to the last
    double u = 0.0;                     ///< of per_run, by the scatter or by the passes
    double p_scatter = 1.0;             ///< against the scatter within the passes
    double p_passes = 1.0;              ///< line through the single passes
    double p_runs = 1.0;                ///< line through the runs; 1 for fewer than three
    bool monotone = false;              ///< every run further than the one before
    bool agree = true;                  ///< the directions by themselves: as large within a half
  };
  Part offset, slope;
  double scatter = 0.0;     ///< standard deviation of a reading within its pass
  double middle = 0.0;      ///< where the offset is that of the pass
  std::size_t runs = 0;     ///< with readings
  std::vector<double> lag;  ///< of each target; empty if measured from one direction

  /// The reversal along the axis shows the drift within the passes: share of it, and its p.
  double seen_in_reversal = 0.0, p_reversal = 1.0;

  double per_run_at(double x) const { return offset.per_run + slope.per_run * (x - middle); }
  double u_at(double x) const;
};
Drift estimate_drift(const AxisTest&);

/// What drift that was not excluded, and repetition, make of these values; expanded (k = 2), m or rad.
/// The estimate of the drift is not taken off the values, so it counts in full.
struct DriftShare {
  double B = 0.0;       ///< at the worst target
  double B_mean = 0.0;  ///< mean over the targets
  double s = 0.0;       ///< in the largest standard deviation of a target and direction
};
DriftShare drift_share(const AxisTest&);

}  // namespace nonio::math
