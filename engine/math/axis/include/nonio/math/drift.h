// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "nonio/math/axis_test.h"

/// Drift of the readings over the runs of a test.
///
///     o_p, q_p offset and slope of pass p (m or rad; m/m): of its readings minus the mean of their
///              target and direction
///     c(t)     course of the drift: t, or T (1 - exp(-t/T)) if it slows down; t in runs
///     per run  slope of one line over c through the passes of both directions
///     lag_i    mean over the runs of c at target i in + minus that in -: the passes of a run follow
///              one another, + upwards and - downwards
///     b_i      (offset per run + slope per run (x_i - middle)) lag_i: contribution of drift to B_i
///
/// Source: derived (docs/dev/estimators.md). `known` is false if no direction has two passes, or
/// with fewer than two targets (four for the slope).
namespace nonio::math {

struct Drift {
  struct Part {
    bool known = false;
    double per_run = 0.0, total = 0.0;  ///< change per run; total: from the first run to the last
    double variance = 0.0, dof = 0.0;   ///< of the passes about the line
    double of_scatter = 0.0;            ///< variance of a pass by the scatter within the passes
    double u = 0.0;  ///< standard uncertainty of per_run, from readings or passes: the larger one
    double p_scatter = 1.0;  ///< p-value of per_run, from the scatter within the passes
    double p_passes = 1.0;   ///< p-value of the slope of the line through the single passes
    double p_runs = 1.0;     ///< p-value of the slope through the runs; 1 for fewer than three runs
    /// Fraction of the variation that a drift which slows down causes in the difference of the passes
    /// of a run that is observed, and p-value of the test that it is 0.
    double seen_in_pairs = 0.0, p_pairs = 1.0;
    bool monotone = false;
    bool agree = true;  ///< false if the drifts of the two directions have opposite signs
  };
  Part offset, slope;
  double scatter = 0.0, scatter_dof = 0.0;  ///< standard deviation of a reading within its pass
  double middle = 0.0;                      ///< position to which the offset of a pass refers
  std::size_t runs = 0;
  double time_constant = INFINITY;  ///< T, in runs; INFINITY: the drift is even
  struct Course {
    double mean = 0.0, variance = 0.0;  ///< of c over the runs
  };
  std::vector<Course> course[2];  ///< of each target, in + and in -

  double in_B_mean = 0.0;  ///< mean of b_i over the targets: contribution of drift to B_mean

  /// Fraction of the variation of the reversal along the axis predicted by b_i that is observed,
  /// and p-value of the test that this fraction is 0.
  double seen_in_reversal = 0.0, p_reversal = 1.0;

  double per_run_at(double x) const { return offset.per_run + slope.per_run * (x - middle); }
  double u_at(double x) const;
  double lag(std::size_t i) const { return course[0][i].mean - course[1][i].mean; }
  double misfit() const;  ///< sum of squares of the passes, relative to the scatter within them
};
/// First the even drift, then some that slow down; empty if no direction has two passes.
std::vector<Drift> estimate_drifts(const AxisTest&);

/// Contributions of drift and repetition to the results of a test that the readings do not exclude;
/// expanded, m or rad. Results are not corrected for drift, so it is included in full.
struct DriftShare {
  double scatter = 0.0;  ///< standard deviation of a reading within its pass, not expanded
  double B = 0.0;        ///< contribution to the largest reversal B_i
  double B_mean = 0.0;
  double U_mean = 0.0;  ///< to the mean of |B_i|: that to B_mean if all have one sign, else to B
  double s = 0.0;  ///< contribution to the largest standard deviation of a target and direction
  double E = 0.0;  ///< contribution to the range of the means of all targets and directions
  double M = 0.0;  ///< contribution to the range of the means of both directions
  double E_after = 0.0, M_after = 0.0;  ///< the same after these means have been compensated
};
DriftShare drift_share(const AxisTest&);

}  // namespace nonio::math
