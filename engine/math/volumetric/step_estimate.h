// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dense.h"
#include "nonio/math/step_diagonals.h"

namespace nonio::math {

/// Returns the column of function E_ba at position i of 1..n; at 0 every function is 0.
inline std::size_t function_column(std::size_t axis, std::size_t along, std::size_t i,
                                   std::size_t n) {
  return (3 * axis + along) * n + i - 1;
}

Eigen::Vector3d direction(const StepDiagonals&, const StepDiagonals::Pass&);
/// Returns the nominal displacement after t moves, m.
Eigen::Vector3d displacement(const StepDiagonals&, const StepDiagonals::Pass&, std::size_t t);

/// Derivatives of the function values by the readings.
struct Sensitivity {
  const ReadingModel* model = nullptr;
  Eigen::MatrixXd of_readings{};  ///< function values x readings, in the order of the model
};

/// Uses the gauge of ISO 230-1. `known`: whether the scale of X, Y, Z is known.
void present(const StepDiagonals&, const Eigen::VectorXd& values, const Eigen::MatrixXd& covariance,
             const Sensitivity&, const std::array<bool, 3>& known, StepSolution& out);

}  // namespace nonio::math
