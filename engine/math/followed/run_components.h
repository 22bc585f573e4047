// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "axis/pass_model.h"
#include "nonio/math/axis_test.h"

namespace nonio::math {

struct RunComponents {
  /// A variance over the runs: the estimate from the values of the runs (`whole`), the contribution
  /// of single readings to it (`noise`), and their difference, at least 0 (`variance`).
  struct Part {
    double variance = 0.0, noise = 0.0, whole = 0.0;
  };
  PassModel passes;
  double runs = 0.0;       ///< number of complete runs: with a pass in each direction that occurs
  double reading[2] = {};  ///< variance of a single reading in directions + and -
  /// Correlation of adjacent targets of a pass; at distance k its k-th power. 0 if not significant.
  double neighbours = 0.0;
  /// Residual degrees of freedom of a pass, relative to those without correlation.
  double independent = 1.0;
  /// Variance over the runs, m^2 or rad^2, of the offset that both passes of a run share (their
  /// mean), and of half the difference of their offsets.
  Part shared_offset, own_offset;
  /// Variances over the runs of the corresponding slopes of the passes, (m/m)^2 or (rad/rad)^2.
  Part shared_slope, own_slope;
};

RunComponents run_components(const AxisTest&);

/// Weights of a linear function of the readings. Element 2 i is the weight of every reading at
/// target i in direction +, element 2 i + 1 that in direction -.
using TargetWeights = std::vector<double>;

double value_of(const AxisTest&, const TargetWeights&);

/// Returns the covariance matrix of linear functions of the readings, row by row.
std::vector<double> covariance_of(const AxisTest&, const RunComponents&,
                                  const std::vector<TargetWeights>&);

/// Root mean square scatter at a target, and the standard uncertainty of its logarithm. Residuals,
/// run offsets and run slopes contribute independently, each with its degrees of freedom.
struct PooledScatter {
  double s = 0.0, u_ln = 0.0;
};
PooledScatter pooled_scatter(const AxisTest&, const RunComponents&);

}  // namespace nonio::math
