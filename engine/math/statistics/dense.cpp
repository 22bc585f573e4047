// SPDX-License-Identifier: Apache-2.0
#include "dense.h"

namespace Eigen {

template class ColPivHouseholderQR<MatrixXd>;
template class HouseholderQR<MatrixXd>;
template class JacobiSVD<MatrixXd>;
template class LDLT<MatrixXd>;
template class LLT<MatrixXd>;
template class PartialPivLU<MatrixXd>;
template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

}  // namespace Eigen

namespace nonio::math {

Spectrum spectrum(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd product(const MatrixXd& A, const MatrixXd& B) { return A * B; }
VectorXd times(const MatrixXd& A, const VectorXd& x) { return A * x; }
MatrixXd transposed_product(const MatrixXd& A, const MatrixXd& B) { return A.transpose() * B; }
VectorXd transposed_times(const MatrixXd& A, const VectorXd& x) { return A.transpose() * x; }
MatrixXd product_transposed(const MatrixXd& A, const MatrixXd& B) { return A * B.transpose(); }
MatrixXd quadratic_form(const MatrixXd& S, const MatrixXd& B) {
  return transposed_product(B, product(S, B));
}
VectorXd residual(const VectorXd& y, const MatrixXd& A, const VectorXd& x) { return y - A * x; }
double squared_residual(const VectorXd& y, const MatrixXd& A, const VectorXd& x) {
  return (y - A * x).squaredNorm();
}
MatrixXd orthogonal_part(const MatrixXd& Q, const MatrixXd& y) {
  return y - Q * (Q.transpose() * y);
}
VectorXd orthogonal_part(const MatrixXd& Q, const VectorXd& y) {
  return y - Q * (Q.transpose() * y);
}
void take_out(const MatrixXd& Q, MatrixXd& y) { y -= Q * (Q.transpose() * y); }
void take_out(const MatrixXd& Q, VectorXd& y) { y -= Q * (Q.transpose() * y); }
MatrixXd scaled_columns(const MatrixXd& U, const VectorXd& d) { return U * d.asDiagonal(); }
MatrixXd scaled_rows(const VectorXd& d, const MatrixXd& U) { return d.asDiagonal() * U; }

VectorXd solution(const Eigen::ColPivHouseholderQR<MatrixXd>& qr, const VectorXd& y) {
  return qr.solve(y);
}
VectorXd solution(const Eigen::LLT<MatrixXd>& llt, const VectorXd& y) { return llt.solve(y); }
MatrixXd solutions(const Eigen::LLT<MatrixXd>& llt, const MatrixXd& Y) { return llt.solve(Y); }
VectorXd solution(const Eigen::LDLT<MatrixXd>& ldlt, const VectorXd& y) { return ldlt.solve(y); }
VectorXd least_squares(const MatrixXd& A, const VectorXd& y) {
  return A.colPivHouseholderQr().solve(y);
}
VectorXd whitened(const Eigen::LLT<MatrixXd>& N, const VectorXd& y) { return N.matrixL().solve(y); }
MatrixXd whitened(const Eigen::LLT<MatrixXd>& N, const MatrixXd& Y) { return N.matrixL().solve(Y); }
MatrixXd inverse(const Eigen::ColPivHouseholderQR<MatrixXd>& qr) {
  return qr.solve(MatrixXd::Identity(qr.rows(), qr.cols()));
}
MatrixXd inverse(const Eigen::LDLT<MatrixXd>& ldlt) {
  return ldlt.solve(MatrixXd::Identity(ldlt.rows(), ldlt.cols()));
}
MatrixXd inverse(const MatrixXd& A) { return A.inverse(); }
MatrixXd inverse_of_upper(const MatrixXd& R) {
  return R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(R.rows(), R.cols()));
}
VectorXd solution_of_upper(const MatrixXd& R, const VectorXd& y) {
  return R.triangularView<Eigen::Upper>().solve(y);
}
MatrixXd solutions_of_upper(const MatrixXd& R, const MatrixXd& Y) {
  return R.triangularView<Eigen::Upper>().solve(Y);
}

MatrixXd orthonormal(const Eigen::HouseholderQR<MatrixXd>& qr, Index columns) {
  return qr.householderQ() * MatrixXd::Identity(qr.rows(), columns);
}
MatrixXd orthonormal(const Eigen::ColPivHouseholderQR<MatrixXd>& qr, Index columns) {
  return qr.householderQ() * MatrixXd::Identity(qr.rows(), columns);
}
VectorXd rotated(const Eigen::HouseholderQR<MatrixXd>& qr, const VectorXd& y) {
  return qr.householderQ().transpose() * y;
}
MatrixXd upper(const Eigen::HouseholderQR<MatrixXd>& qr, Index rows) {
  return qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
}
MatrixXd pseudo_inverse(const Eigen::ColPivHouseholderQR<MatrixXd>& qr) {
  // A P = Q R; the rows of R up to the rank are R = T' Z' with Z' Z = 1.
  const Index rank = qr.rank();
  const MatrixXd R = qr.matrixR().topRows(rank).triangularView<Eigen::Upper>();
  const Eigen::HouseholderQR<MatrixXd> rows(R.transpose());
  const MatrixXd half = product(orthonormal(qr, rank), inverse_of_upper(upper(rows, rank)));
  return qr.colsPermutation() * product_transposed(orthonormal(rows, rank), half);
}

MatrixXd left_columns(const MatrixXd& A, Index count) { return A.leftCols(count); }
MatrixXd columns(const MatrixXd& A, Index first, Index count) { return A.middleCols(first, count); }
MatrixXd with_column(const MatrixXd& A, const VectorXd& y) {
  MatrixXd out(A.rows(), A.cols() + 1);
  out.leftCols(A.cols()) = A;
  out.col(A.cols()) = y;
  return out;
}

}  // namespace nonio::math
