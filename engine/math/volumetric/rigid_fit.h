// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dense.h"
#include "rigid_terms.h"

/// The least-squares fit of rigid_body.h: terms, which are identifiable, scatter of the groups.
namespace nonio::math {

/// Readings, their terms and the set-up, in one matrix each.
struct RigidTable {
  Eigen::MatrixXd terms, set_up;
  Eigen::VectorXd value;
  std::vector<std::size_t> group;  ///< `groups` of what is stated
  std::vector<double> stated;      ///< standard uncertainty; 0 of a reading
  std::size_t groups = 0;
};

/// One fit with the readings divided by the scatter of their groups.
struct RigidSolved {
  Eigen::VectorXd x, residual;  ///< residual: of the readings divided by their scatter
  Eigen::MatrixXd V, map;       ///< kept right vectors; unknowns by readings
  Eigen::VectorXd sigma;        ///< all, falling
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
  double price = 0.0;  ///< by Schwarz's criterion
};

RigidFit fit_rigid_body(const std::vector<RigidLine>&, const RigidBox&,
                        const std::vector<std::string>& errors, std::size_t degree);

}  // namespace nonio::math
