// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dense.h"
#include "nonio/math/followed.h"
#include "run_components.h"

namespace nonio::math {

/// Returns columns P0(z), P1(z), ... at the targets; z is -1 at the first and 1 at the last.
Eigen::MatrixXd legendre_columns(const AxisTest&, int columns);

/// Returns the matrix `others` with two more columns, cos and sin of 2 pi x/period at the targets.
Eigen::MatrixXd with_sinusoid(const Eigen::MatrixXd& others, const AxisTest&, double period);

/// Returns one row of weights per column of X: its coefficient in a least-squares fit to values at
/// the targets. The columns must be independent.
Eigen::MatrixXd fit_rows(const Eigen::MatrixXd& X);

/// Returns the weights of sum t_i m_i over targets; each direction from which a target was
/// approached has the same weight in m_i.
TargetWeights of_means(const AxisTest&, const Eigen::VectorXd& t);

/// Returns the weights of the mean of B_i over the targets approached from both directions.
TargetWeights of_reversal(const AxisTest&);

/// Variance of the linear function if the values at the targets (reversals B_i if `reversal`,
/// otherwise means) are independent with variance 1.
double share_of_targets(const AxisTest&, const TargetWeights&, bool reversal);

/// Fits a polynomial (a constant if a period is a full turn) and sinusoids with these periods (m or
/// rad) to the means m_i. Empty if the targets do not determine the fit.
TargetFit fit_means(const AxisTest&, const RunComponents&, const std::vector<double>& periods);
/// Fits a polynomial to the reversals B_i; empty if the targets do not determine the fit.
TargetFit fit_reversal(const AxisTest&, const RunComponents&);

}  // namespace nonio::math
