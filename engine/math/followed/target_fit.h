// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dense.h"
#include "nonio/math/followed.h"
#include "run_components.h"

namespace nonio::math {

/// Columns P0(z), P1(z), ... at the targets; z is -1 at the first and 1 at the last.
Eigen::MatrixXd legendre_columns(const AxisTest&, int columns);

/// And cos and sin of 2 pi x/period.
Eigen::MatrixXd with_sinusoid(const Eigen::MatrixXd& others, const AxisTest&, double period);

/// Rows: coefficient of each column, which are independent, in a least-squares fit to the targets, by
/// target. No larger than X: there may be many targets.
Eigen::MatrixXd fit_rows(const Eigen::MatrixXd& X);

/// Of a sum over targets of t_i m_i: each direction that reached the target counts alike.
TargetWeights of_means(const AxisTest&, const Eigen::VectorXd& t);

/// Mean of B_i over the targets that were reached from both directions.
TargetWeights of_reversal(const AxisTest&);

/// Variance of the function where independent values at the targets have variance 1.
double share_of_targets(const AxisTest&, const TargetWeights&, bool reversal);

/// Of the means of both directions.
TargetFit fit_means(const AxisTest&, const RunComponents&, const std::vector<double>& periods);
/// Of B_i: of a bidirectional test.
TargetFit fit_reversal(const AxisTest&, const RunComponents&);

}  // namespace nonio::math
