// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dense.h"
#include "nonio/math/step_diagonals.h"

/// What both methods of step_diagonals.h share.
namespace nonio::math {

/// Column of function E_ba at position i of 1..n; at 0 every function is 0.
inline std::size_t function_column(std::size_t axis, std::size_t along, std::size_t i,
                                   std::size_t n) {
  return (3 * axis + along) * n + i - 1;
}

/// Direction of a pass.
Eigen::Vector3d direction(const StepDiagonals&, const StepDiagonals::Pass&);
/// Nominal displacement after t moves.
Eigen::Vector3d displacement(const StepDiagonals&, const StepDiagonals::Pass&, std::size_t t);

/// What the function values depend on.
struct Sensitivity {
  const ReadingModel* model = nullptr;
  Eigen::MatrixXd of_readings{};  ///< function values by readings, in the order of the model
};

/// Curves and squareness in the gauge of ISO 230-1 from function values and their covariance.
/// known: of X, Y, Z, whether the scale is.
void present(const StepDiagonals&, const Eigen::VectorXd& values, const Eigen::MatrixXd& covariance,
             const Sensitivity&, const std::array<bool, 3>& known, StepSolution& out);

}  // namespace nonio::math
