// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

/// Eigen with its dense solvers compiled once, in statistics/dense.cpp: each costs a source that
/// compiles it itself 7 to 17 s. Not installed.
namespace Eigen {

extern template class ColPivHouseholderQR<MatrixXd>;
extern template class HouseholderQR<MatrixXd>;
extern template class JacobiSVD<MatrixXd>;
extern template class LDLT<MatrixXd>;
extern template class LLT<MatrixXd>;
extern template class PartialPivLU<MatrixXd>;
extern template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

}  // namespace Eigen

namespace nonio::math {

/// Eigenvalues, ascending, and in their order the unit eigenvectors as columns.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Eigenvalues of a symmetric matrix. A function, so that its loops are compiled only here: -O3
/// makes them 1.7 times as fast.
Spectrum spectrum(const Eigen::MatrixXd& symmetric);

/// Products and solutions of dense matrices, compiled once in statistics/dense.cpp. A product written
/// with operators is compiled again for each combination of blocks and transposes, and in each source.
/// Functions of a vector have names of their own, so that they take its expressions too.
Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::VectorXd times(const Eigen::MatrixXd& A, const Eigen::VectorXd& x);
/// A' B
Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::VectorXd transposed_times(const Eigen::MatrixXd& A, const Eigen::VectorXd& x);
/// A B'
Eigen::MatrixXd product_transposed(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// B' S B
Eigen::MatrixXd quadratic_form(const Eigen::MatrixXd& S, const Eigen::MatrixXd& B);
/// y - A x
Eigen::VectorXd residual(const Eigen::VectorXd& y, const Eigen::MatrixXd& A,
                         const Eigen::VectorXd& x);
/// |y - A x|^2
double squared_residual(const Eigen::VectorXd& y, const Eigen::MatrixXd& A,
                        const Eigen::VectorXd& x);
/// y - Q Q' y: the part of each column of y that is orthogonal to the orthonormal columns of Q.
Eigen::MatrixXd orthogonal_part(const Eigen::MatrixXd& Q, const Eigen::MatrixXd& y);
Eigen::VectorXd orthogonal_part(const Eigen::MatrixXd& Q, const Eigen::VectorXd& y);
/// The same in place.
void take_out(const Eigen::MatrixXd& Q, Eigen::MatrixXd& y);
void take_out(const Eigen::MatrixXd& Q, Eigen::VectorXd& y);
/// U diag(d)
Eigen::MatrixXd scaled_columns(const Eigen::MatrixXd& U, const Eigen::VectorXd& d);
/// diag(d) U
Eigen::MatrixXd scaled_rows(const Eigen::VectorXd& d, const Eigen::MatrixXd& U);

Eigen::VectorXd solution(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr,
                         const Eigen::VectorXd& y);
Eigen::VectorXd solution(const Eigen::LLT<Eigen::MatrixXd>& llt, const Eigen::VectorXd& y);
Eigen::MatrixXd solutions(const Eigen::LLT<Eigen::MatrixXd>& llt, const Eigen::MatrixXd& Y);
Eigen::VectorXd solution(const Eigen::LDLT<Eigen::MatrixXd>& ldlt, const Eigen::VectorXd& y);
/// x of the least |y - A x|, by a decomposition with pivots.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& y);
/// L^-1 Y of N = L L'
Eigen::VectorXd whitened(const Eigen::LLT<Eigen::MatrixXd>& N, const Eigen::VectorXd& y);
Eigen::MatrixXd whitened(const Eigen::LLT<Eigen::MatrixXd>& N, const Eigen::MatrixXd& Y);
/// The inverse by each decomposition: the solution for the unit matrix.
Eigen::MatrixXd inverse(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr);
Eigen::MatrixXd inverse(const Eigen::LDLT<Eigen::MatrixXd>& ldlt);
/// Moore-Penrose, with the rank of the decomposition.
Eigen::MatrixXd pseudo_inverse(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr);
/// Of a square matrix, by elimination.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);
/// The inverse of an upper triangular matrix.
Eigen::MatrixXd inverse_of_upper(const Eigen::MatrixXd& R);
/// R^-1 y, R upper triangular
Eigen::VectorXd solution_of_upper(const Eigen::MatrixXd& R, const Eigen::VectorXd& y);
Eigen::MatrixXd solutions_of_upper(const Eigen::MatrixXd& R, const Eigen::MatrixXd& Y);

/// The first columns of the orthogonal factor of a decomposition.
Eigen::MatrixXd orthonormal(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::Index columns);
Eigen::MatrixXd orthonormal(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr,
                            Eigen::Index columns);
/// Q' y of a decomposition.
Eigen::VectorXd rotated(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, const Eigen::VectorXd& y);
/// The upper triangle of the first `rows` rows of a decomposition.
Eigen::MatrixXd upper(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::Index rows);

/// Copies of columns, from the first one on or from `first` on.
Eigen::MatrixXd left_columns(const Eigen::MatrixXd& A, Eigen::Index count);
Eigen::MatrixXd columns(const Eigen::MatrixXd& A, Eigen::Index first, Eigen::Index count);
/// A with y as a further column.
Eigen::MatrixXd with_column(const Eigen::MatrixXd& A, const Eigen::VectorXd& y);

/// A count or position as Eigen requires it.
inline Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

}  // namespace nonio::math
