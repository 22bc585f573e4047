// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

/// Eigen with its dense solvers compiled once, in src/dense.cpp: each costs a source that compiles
/// it itself 7 to 17 s. Not installed.
namespace Eigen {

extern template class ColPivHouseholderQR<MatrixXd>;
extern template class HouseholderQR<MatrixXd>;
extern template class JacobiSVD<MatrixXd>;
extern template class LDLT<MatrixXd>;
extern template class LLT<MatrixXd>;
extern template class PartialPivLU<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;

}  // namespace Eigen

namespace nonio::math {

/// A count or position as Eigen wants it.
inline Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

}  // namespace nonio::math
