// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "eigen/dense.h"

namespace nonio::math {

/// Noise of means along the path: the sum of white noise and a first-order autoregressive process.
///
///     cov(y_i, y_j) = s^2 [(1 - w) (i == j) + w rho^|i - j|]
///
/// rho and w by restricted maximum likelihood (REML), so that what the fitted columns take of slow
/// noise does not make it look smaller. The filter is Kalman's of one state: O(n).
struct PathNoise {
  double rho = 0.0, w = 0.0;
  /// Variance of a slow column against that of white noise of the same size.
  double slow() const { return (1.0 - w) + w * (1.0 + rho) / (1.0 - rho); }
};

/// Columns (the last one is the deviation) made white for s = 1, in place; returns ln det of the
/// covariance. place: number of the bin of each row, ascending.
double whiten(Eigen::MatrixXd& columns, const std::vector<int>& place, const PathNoise& noise);

/// Of the residuals of y on X.
PathNoise path_noise(const Eigen::MatrixXd& X, const Eigen::VectorXd& y,
                     const std::vector<int>& place);

}  // namespace nonio::math
