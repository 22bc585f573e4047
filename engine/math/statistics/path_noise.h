// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "eigen/dense.h"

namespace nonio::math {

/// Noise of means along the path: the sum of white noise and a first-order autoregressive process.
///
///     cov(y_i, y_j) = s^2 [(1 - w) (i == j) + w rho^|i - j|]
///
/// Restricted maximum likelihood (REML) estimates rho and w, so that slow noise absorbed by the
/// fitted columns does not bias them. A Kalman filter makes the cost linear in the number of means.
struct PathNoise {
  double rho = 0.0, w = 0.0;
  /// Variance of the coefficient of a slow column, relative to that with white noise of equal size.
  double slow() const { return (1.0 - w) + w * (1.0 + rho) / (1.0 - rho); }
};

/// Whitens the columns for s = 1, and returns ln det of the covariance. `place`: position of each
/// row along the path, ascending.
double whiten(Eigen::MatrixXd& columns, const std::vector<int>& place, const PathNoise& noise);

/// Estimates rho and w by a fit of y to the columns of X. `place`: as for `whiten`.
PathNoise path_noise(const Eigen::MatrixXd& X, const Eigen::VectorXd& y,
                     const std::vector<int>& place);

}  // namespace nonio::math
