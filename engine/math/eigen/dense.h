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

}  // namespace Eigen

namespace nonio::math {

/// Eigenvalues, ascending, and in their order the unit eigenvectors as columns.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Of a symmetric matrix. A function, so that nobody else compiles its loops: -O3 makes them
/// 1.7 times as fast.
Spectrum spectrum(const Eigen::MatrixXd& symmetric);

/// A count or position as Eigen wants it.
inline Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

}  // namespace nonio::math
