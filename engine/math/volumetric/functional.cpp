// SPDX-License-Identifier: Apache-2.0
#include "functional.h"

#include <cmath>

namespace nonio::math {

double Estimator::u(const Eigen::RowVectorXd& row) const {
  return std::sqrt(std::max(0.0, (row * covariance).dot(row)));
}

Shares Estimator::shares(const Eigen::RowVectorXd& row) const {
  if (model == nullptr) return {};
  const Eigen::RowVectorXd J = row * of_readings;
  Shares out = model->shares({J.data(), static_cast<std::size_t>(J.size())});
  if (dof) out.dof = dof(J);
  return out;
}

VolumeMap map_of(const Estimator& estimator, const ErrorRows& rows, const Corner& low,
                 const Corner& high, std::size_t parts) {
  VolumeMap map;
  map.parts = parts;
  Corner middle{};
  for (std::size_t k = 0; k < 3; ++k) middle[k] = (low[k] + high[k]) / 2.0;
  const Eigen::MatrixXd zero = rows(middle);
  Eigen::RowVectorXd along;
  for (const Corner& place : lattice(low, high, parts)) {
    const Eigen::MatrixXd here = rows(place) - zero;
    VolumeNode node;
    node.at = place;
    const Eigen::Vector3d e = here * estimator.x;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::RowVectorXd row = here.row(at(k));
      node.error[k] = e[at(k)];
      node.u[k] = estimator.u(row);
      node.shares[k] = estimator.shares(row);
    }
    if (e.norm() > map.size || along.size() == 0) {
      map.size = e.norm();
      map.largest = map.nodes.size();
      along = map.size > 0.0 ? Eigen::RowVectorXd(e.transpose() / map.size * here)
                             : Eigen::RowVectorXd(here.row(0));
    }
    map.nodes.push_back(std::move(node));
  }
  map.u_size = estimator.u(along);
  map.shares_size = estimator.shares(along);
  return map;
}

}  // namespace nonio::math
