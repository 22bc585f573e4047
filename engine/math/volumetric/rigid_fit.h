// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dense.h"
#include "rigid_terms.h"

namespace nonio::math {

/// Matrices of the terms and of the set-up, one row per reading.
struct RigidTable {
  Eigen::MatrixXd terms, set_up;
  Eigen::VectorXd value;
  std::vector<std::size_t> group;  ///< group of each row; `groups` for stated values
  std::vector<double> stated;      ///< standard uncertainty of stated values; 0 for readings
  std::size_t groups = 0;
};

struct RigidSolved {
  Eigen::VectorXd x, residual;  ///< solution; residuals of the readings divided by their scatter
  /// right singular vectors up to the rank, as columns; matrix from readings to unknowns
  Eigen::MatrixXd V, map;
  Eigen::VectorXd sigma;  ///< all singular values, descending
  Eigen::VectorXd leverage;
  Eigen::Index rank = 0, set_up = 0;
};

struct RigidScatter {
  std::vector<double> s, dof;
};

struct RigidFit {
  std::vector<RigidTerm> terms;
  RigidTable table;
  RigidSolved solved;
  RigidScatter scatter;
  double price = 0.0;  ///< value of Schwarz's criterion; the smallest is the best fit
};

RigidFit fit_rigid_body(const std::vector<RigidLine>&, const RigidBox&,
                        const std::vector<std::string>& errors, std::size_t degree);

}  // namespace nonio::math
