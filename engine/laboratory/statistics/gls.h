// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "laboratory/statistics/series.h"
#include "math/eigen/dense.h"

namespace nonio::statistics {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd covariance_of(const Series&);

/// Values of the points, whitened by the Cholesky factor of their covariance. If `spread` is
/// positive, an additional row contains the prior of the slope: slope / spread = 0 +- 1.
struct Whitened {
  explicit Whitened(const Series&);
  /// Returns a whitened column of the model, with 0 in the row of the prior.
  VectorXd column(const VectorXd&) const;
  /// Returns the whitened column of the slope, with 1 / spread in the row of the prior.
  VectorXd slope(const VectorXd& times) const;
  double spread = 0.0;
  Eigen::LLT<MatrixXd> factor;
  VectorXd y;
};

struct Gls {
  VectorXd b;
  MatrixXd C;
  MatrixXd basis;  ///< orthonormal basis of the whitened columns
  double chi2 = 0.0, dof = 0.0;
};

/// Generalized least squares. Returns std::nullopt if the columns are linearly dependent or
/// outnumber the rows.
std::optional<Gls> gls(const Whitened&, const MatrixXd& whitened_columns);

double normal_two_sided(double z);  ///< P(|N| > |z|) for a standard normal N
double normal_upper(double z);      ///< P(N > z) for a standard normal N

}  // namespace nonio::statistics
