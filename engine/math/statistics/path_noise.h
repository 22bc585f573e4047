// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "eigen/dense.h"

namespace nonio::math {

/// Noise of means along the path: the sum of white noise and a first-order autoregressive process.
///
///     cov(y_i, y_j) = s^2 [(1 - w) (i == j) + w rho^|i - j|]
///
/// rho and w are estimated by restricted maximum likelihood (REML), so that slow noise absorbed by
/// the fitted columns does not bias them. The covariance is inverted by a Kalman filter with one
/// state, so the cost grows linearly with the number of means.
struct PathNoise {
  double rho = 0.0, w = 0.0;
  /// Returns the variance of the coefficient of a slow column, relative to that with white noise of
  /// the same size.
  double slow() const { return (1.0 - w) + w * (1.0 + rho) / (1.0 - rho); }
};

/// Whitens the columns for s = 1, in place, and returns ln det of the covariance. place: position
/// of each row along the path, ascending integers.
double whiten(Eigen::MatrixXd& columns, const std::vector<int>& place, const PathNoise& noise);

/// Estimates rho and w from the residuals of a fit of y to the columns of X. place: as for
/// `whiten`.
PathNoise path_noise(const Eigen::MatrixXd& X, const Eigen::VectorXd& y,
                     const std::vector<int>& place);

}  // namespace nonio::math
