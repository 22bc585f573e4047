// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "dense.h"
#include "nonio/math/budget.h"
#include "nonio/math/volume_map.h"

/// Linear results of a fit: value, u of the repetition, shares of the inputs.
namespace nonio::math {

/// Unknowns with their covariance and, if there is a model, their derivatives by the readings.
struct Estimator {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd of_readings{};
  const ReadingModel* model = nullptr;
  /// Of the repetition, for a row of derivatives by the readings; none: as the budget has them.
  std::function<double(const Eigen::RowVectorXd&)> dof{};

  double value(const Eigen::RowVectorXd& row) const { return row.dot(x); }
  double u(const Eigen::RowVectorXd& row) const;
  Shares shares(const Eigen::RowVectorXd& row) const;
};

/// Rows of the three components of the error at a place.
using ErrorRows = std::function<Eigen::MatrixXd(const Corner&)>;

/// The map of what `rows` gives, less that in the middle of the volume.
VolumeMap map_of(const Estimator&, const ErrorRows& rows, const Corner& low, const Corner& high,
                 std::size_t parts);

}  // namespace nonio::math
