// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "dense.h"
#include "nonio/math/budget.h"
#include "nonio/math/volume_map.h"

namespace nonio::math {

/// Fitted unknowns with their covariance; `of_readings` needs a model.
struct Estimator {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd of_readings{};
  const ReadingModel* model = nullptr;
  /// Degrees of freedom of the repetition for derivatives by the readings; empty: of the budget.
  std::function<double(const Eigen::RowVectorXd&)> dof{};

  double value(const Eigen::RowVectorXd& row) const { return row.dot(x); }
  double u(const Eigen::RowVectorXd& row) const;
  Shares shares(const Eigen::RowVectorXd& row) const;
};

/// Returns, for a position, three rows that give the components of the error from the unknowns.
using ErrorRows = std::function<Eigen::MatrixXd(const Corner&)>;

/// Returns the map of the error that `rows` gives, minus that at the middle of the volume.
VolumeMap map_of(const Estimator&, const ErrorRows& rows, const Corner& low, const Corner& high,
                 std::size_t parts);

}  // namespace nonio::math
