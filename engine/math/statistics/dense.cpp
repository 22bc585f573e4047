// SPDX-License-Identifier: Apache-2.0
#include "dense.h"

namespace Eigen {

template class ColPivHouseholderQR<MatrixXd>;
template class HouseholderQR<MatrixXd>;
template class JacobiSVD<MatrixXd>;
template class LDLT<MatrixXd>;
template class LLT<MatrixXd>;
template class PartialPivLU<MatrixXd>;

}  // namespace Eigen

namespace nonio::math {

Spectrum spectrum(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace nonio::math
