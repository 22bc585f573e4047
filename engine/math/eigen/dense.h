// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

/// Declares that the dense solvers of Eigen are compiled once, in statistics/dense.cpp, because
/// each source that compiles them itself takes 7 to 17 s longer. This header is not installed.
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

/// Eigenvalues in ascending order, and their unit eigenvectors as columns.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Not inline, so that its loops are compiled only in one file: -O3 makes them 1.7 times as fast.
Spectrum spectrum(const Eigen::MatrixXd& symmetric);

/// A product written with operators is compiled again for each combination of blocks and transposes
/// in each source. Functions of a vector have other names, to accept vector expressions.
Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::VectorXd times(const Eigen::MatrixXd& A, const Eigen::VectorXd& x);
Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::VectorXd transposed_times(const Eigen::MatrixXd& A, const Eigen::VectorXd& x);
Eigen::MatrixXd product_transposed(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::MatrixXd quadratic_form(const Eigen::MatrixXd& S, const Eigen::MatrixXd& B);
Eigen::VectorXd residual(const Eigen::VectorXd& y, const Eigen::MatrixXd& A,
                         const Eigen::VectorXd& x);
double squared_residual(const Eigen::VectorXd& y, const Eigen::MatrixXd& A,
                        const Eigen::VectorXd& x);
/// Returns y - Q Q' y, for orthonormal columns of Q.
Eigen::MatrixXd orthogonal_part(const Eigen::MatrixXd& Q, const Eigen::MatrixXd& y);
Eigen::VectorXd orthogonal_part(const Eigen::MatrixXd& Q, const Eigen::VectorXd& y);
/// Replaces y by y - Q Q' y.
void take_out(const Eigen::MatrixXd& Q, Eigen::MatrixXd& y);
void take_out(const Eigen::MatrixXd& Q, Eigen::VectorXd& y);
Eigen::MatrixXd scaled_columns(const Eigen::MatrixXd& U, const Eigen::VectorXd& d);
Eigen::MatrixXd scaled_rows(const Eigen::VectorXd& d, const Eigen::MatrixXd& U);

Eigen::VectorXd solution(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr,
                         const Eigen::VectorXd& y);
Eigen::VectorXd solution(const Eigen::LLT<Eigen::MatrixXd>& llt, const Eigen::VectorXd& y);
Eigen::MatrixXd solutions(const Eigen::LLT<Eigen::MatrixXd>& llt, const Eigen::MatrixXd& Y);
Eigen::VectorXd solution(const Eigen::LDLT<Eigen::MatrixXd>& ldlt, const Eigen::VectorXd& y);
/// Returns the x with the smallest |y - A x|, by a decomposition with pivoting.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& y);
/// Returns L^-1 y, with N = L L'.
Eigen::VectorXd whitened(const Eigen::LLT<Eigen::MatrixXd>& N, const Eigen::VectorXd& y);
Eigen::MatrixXd whitened(const Eigen::LLT<Eigen::MatrixXd>& N, const Eigen::MatrixXd& Y);
Eigen::MatrixXd inverse(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr);
Eigen::MatrixXd inverse(const Eigen::LDLT<Eigen::MatrixXd>& ldlt);
Eigen::MatrixXd pseudo_inverse(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr);
Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);
Eigen::MatrixXd inverse_of_upper(const Eigen::MatrixXd& R);
Eigen::VectorXd solution_of_upper(const Eigen::MatrixXd& R, const Eigen::VectorXd& y);
Eigen::MatrixXd solutions_of_upper(const Eigen::MatrixXd& R, const Eigen::MatrixXd& Y);

Eigen::MatrixXd orthonormal(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::Index columns);
Eigen::MatrixXd orthonormal(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr,
                            Eigen::Index columns);
/// Returns Q' y of a decomposition.
Eigen::VectorXd rotated(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, const Eigen::VectorXd& y);
/// Returns the upper triangle of the first `rows` rows of a decomposition.
Eigen::MatrixXd upper(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::Index rows);

Eigen::MatrixXd left_columns(const Eigen::MatrixXd& A, Eigen::Index count);
Eigen::MatrixXd columns(const Eigen::MatrixXd& A, Eigen::Index first, Eigen::Index count);
Eigen::MatrixXd with_column(const Eigen::MatrixXd& A, const Eigen::VectorXd& y);

inline Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

}  // namespace nonio::math
