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

/// Points whitened by the Cholesky factor of their covariance. If the spread of slopes is known,
/// one more row follows: slope / spread = 0 +- 1.
struct Whitened {
  explicit Whitened(const Series&);
  /// Returns a column of the model, whitened.
  VectorXd column(const VectorXd&) const;
  /// Returns the whitened column of the slope, with its additional row.
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

/// Fits the columns by generalised least squares. Returns none if the points cannot separate the
/// columns.
std::optional<Gls> gls(const Whitened&, const MatrixXd& whitened_columns);

double normal_two_sided(double z);  ///< returns P(|N| > |z|) for a standard normal N
double normal_upper(double z);      ///< returns P(N > z) for a standard normal N

}  // namespace nonio::statistics
