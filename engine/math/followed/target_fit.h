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

/// Returns the matrix whose rows give the coefficient of each column of X in a least-squares fit to
/// values at the targets; the columns must be independent. It is not larger than X, because there
/// may be many targets.
Eigen::MatrixXd fit_rows(const Eigen::MatrixXd& X);

/// Returns the weights of sum t_i m_i over targets; each direction from which a target was
/// approached has the same weight in m_i.
TargetWeights of_means(const AxisTest&, const Eigen::VectorXd& t);

/// Returns the weights of the mean of B_i over the targets approached from both directions.
TargetWeights of_reversal(const AxisTest&);

/// Returns the variance of the linear function with these weights if the values at the targets are
/// independent and have the variance 1. The values are the reversals B_i if `reversal`, else the
/// means.
double share_of_targets(const AxisTest&, const TargetWeights&, bool reversal);

/// Fits a polynomial, and sinusoids with these periods (m or rad), to the mean deviation m_i at
/// each target. If a period is a full turn, the polynomial is a constant. The fit is empty if the
/// targets do not determine it.
TargetFit fit_means(const AxisTest&, const RunComponents&, const std::vector<double>& periods);
/// Fits a polynomial to the reversals B_i of a bidirectional test. The fit is empty if the targets
/// approached from both directions do not determine it.
TargetFit fit_reversal(const AxisTest&, const RunComponents&);

}  // namespace nonio::math
