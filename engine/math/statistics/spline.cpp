// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "dense.h"

namespace nonio::math {

namespace {

struct Knots {
  double first, step;
  int intervals;
};

/// Returns the interval of x and the four cubic B-splines that are not zero at x.
std::pair<int, std::array<double, 4>> b_splines(const Knots& knots, double x) {
  const double at = (x - knots.first) / knots.step;
  const double last = knots.intervals - 1;
  const double interval =
      at >= 0.0 ? std::min(std::floor(at), last) : 0.0;  // the first interval if x is NaN
  const double s = at - interval, r = 1.0 - s;
  return {static_cast<int>(interval),
          {r * r * r / 6.0, ((3.0 * s - 6.0) * s * s + 4.0) / 6.0,
           (((-3.0 * s + 3.0) * s + 3.0) * s + 1.0) / 6.0, s * s * s / 6.0}};
}

Eigen::MatrixXd b_spline_matrix(const Knots& knots, const std::vector<double>& x) {
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(x.size()),
                                            static_cast<Eigen::Index>(knots.intervals) + 3);
  for (Eigen::Index i = 0; i < b.rows(); ++i) {
    const auto [interval, values] = b_splines(knots, x[static_cast<std::size_t>(i)]);
    for (int k = 0; k < 4; ++k) b(i, interval + k) = values[static_cast<std::size_t>(k)];
  }
  return b;
}

/// B-splines times N span the functions that are orthogonal to constant and slope over the targets;
/// R, from their QR decomposition, makes them orthonormal.
Expected<Eigen::MatrixXd> coefficients(const Eigen::MatrixXd& b,
                                       const std::vector<double>& targets) {
  Eigen::MatrixXd line(b.rows(), 2);
  line.col(0).setOnes();
  line.col(1) = Eigen::Map<const Eigen::VectorXd>(targets.data(), b.rows());
  line.col(1).array() -= line.col(1).mean();
  line.col(1) /= line.col(1).cwiseAbs().maxCoeff();
  const Eigen::MatrixXd constraint = transposed_product(b, line);
  const Eigen::HouseholderQR<Eigen::MatrixXd> split(constraint);
  const Eigen::MatrixXd n = columns(orthonormal(split, b.cols()), 2, b.cols() - 2);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(product(b, n));
  const Eigen::MatrixXd r = upper(qr, n.cols());
  const Eigen::VectorXd size = r.diagonal().cwiseAbs();
  if (!(size.minCoeff() > 1e-6 * size.maxCoeff()))
    return fail("the targets lie so that they do not determine a curve of " +
                std::to_string(n.cols()) + " knots");
  // X = N R^-1: X^T solves R^T X^T = N^T.
  const Eigen::MatrixXd x =
      r.transpose().triangularView<Eigen::Lower>().solve(n.transpose()).transpose();
  return Eigen::MatrixXd(x * std::sqrt(static_cast<double>(b.rows())));
}

}  // namespace

Expected<std::vector<std::vector<double>>> smooth_basis(const std::vector<double>& x,
                                                        const std::vector<double>& targets,
                                                        int knots) {
  if (knots < 2)
    return fail("a smooth curve needs 2 knots or more, found " + std::to_string(knots));
  if (targets.size() < static_cast<std::size_t>(knots) + 2)
    return fail(std::to_string(targets.size()) + " targets do not determine a curve of " +
                std::to_string(knots) + " knots");
  const double length = targets.back() - targets.front();
  if (!(length > 0.0) || !std::isfinite(length))
    return fail("a smooth curve needs targets at different positions");
  const Knots grid{targets.front(), length / (knots - 1), knots - 1};
  NONIO_TRY(const auto c, coefficients(b_spline_matrix(grid, targets), targets));
  std::vector<std::vector<double>> out(static_cast<std::size_t>(knots),
                                       std::vector<double>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto [interval, values] = b_splines(grid, x[i]);
    const Eigen::RowVectorXd row =
        Eigen::Map<const Eigen::RowVector4d>(values.data()) * c.middleRows(interval, 4);
    for (int k = 0; k < knots; ++k) out[static_cast<std::size_t>(k)][i] = row(k);
  }
  return out;
}

}  // namespace nonio::math
