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

/// Points whitened by the Cholesky factor of their covariance; behind them one row more where the
/// spread of slopes is known: slope / spread = 0 +- 1.
struct Whitened {
  explicit Whitened(const Series&);
  /// A column of the model, whitened.
  VectorXd column(const VectorXd&) const;
  /// That of the slope.
  VectorXd slope(const VectorXd& times) const;
  double spread = 0.0;
  Eigen::LLT<MatrixXd> factor;
  VectorXd y;
};

struct Gls {
  VectorXd b;
  MatrixXd C;
  MatrixXd basis;  ///< orthonormal, of the whitened columns
  double chi2 = 0.0, dof = 0.0;
};

/// None if the points cannot separate the columns.
std::optional<Gls> gls(const Whitened&, const MatrixXd& whitened_columns);

double normal_two_sided(double z);  ///< P(|N| > |z|)
double normal_upper(double z);      ///< P(N > z)

}  // namespace nonio::statistics
