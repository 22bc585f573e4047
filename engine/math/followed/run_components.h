// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "axis/pass_model.h"
#include "nonio/math/axis_test.h"

namespace nonio::math {

/// What the scatter of a test is made of (followed.h).
struct RunComponents {
  /// Variance over the runs, what of its estimate single readings make, and the estimate with it.
  struct Part {
    double variance = 0.0, noise = 0.0, whole = 0.0;
  };
  PassModel passes;
  double runs = 0.0;       ///< complete ones: with a pass in each direction that occurs
  double reading[2] = {};  ///< variance of a single reading, + and -
  /// Correlation of neighbouring targets of a pass; at distance k its k-th power. 0 where the
  /// readings do not show one.
  double neighbours = 0.0;
  /// Share of a pass' residual degrees of freedom that neighbours which are alike leave.
  double independent = 1.0;
  Part shared_offset, own_offset;  ///< m^2
  Part shared_slope, own_slope;    ///< slopes about the middle of the targets
};

RunComponents run_components(const AxisTest&);

/// A linear function of the readings: weight of each reading at target i in direction +, at 2 i, and
/// in direction -, at 2 i + 1. All of a target and direction count alike.
using TargetWeights = std::vector<double>;

double value_of(const AxisTest&, const TargetWeights&);

/// Covariances of linear functions of the readings, row by row.
std::vector<double> covariance_of(const AxisTest&, const RunComponents&,
                                  const std::vector<TargetWeights>&);

/// Root mean square of the scatter at a target, and the standard uncertainty of its logarithm: the
/// mean square is the sum of those of the residuals, of the runs' offsets and of their slopes, which
/// are independent, each with its degrees of freedom.
struct PooledScatter {
  double s = 0.0, u_ln = 0.0;
};
PooledScatter pooled_scatter(const AxisTest&, const RunComponents&);

}  // namespace nonio::math
