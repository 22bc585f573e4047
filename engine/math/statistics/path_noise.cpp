// SPDX-License-Identifier: Apache-2.0
#include "statistics/path_noise.h"

#include <cmath>

namespace nonio::math {

double whiten(Eigen::MatrixXd& columns, const std::vector<int>& place, const PathNoise& noise) {
  Eigen::RowVectorXd state = Eigen::RowVectorXd::Zero(columns.cols());
  double variance = noise.w, determinant = 0.0;
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    if (i > 0) {
      const double phi = std::pow(
          noise.rho, place[static_cast<std::size_t>(i)] - place[static_cast<std::size_t>(i) - 1]);
      state *= phi;
      variance = phi * phi * variance + noise.w * (1.0 - phi * phi);
    }
    const double S = variance + (1.0 - noise.w) + 1e-12, gain = variance / S;
    const Eigen::RowVectorXd innovation = columns.row(i) - state;
    state += gain * innovation;
    variance *= 1.0 - gain;
    columns.row(i) = innovation / std::sqrt(S);
    determinant += std::log(S);
  }
  return determinant;
}

namespace {

/// Returns -2 ln of the restricted likelihood, up to a constant.
double criterion(const Eigen::MatrixXd& both, const std::vector<int>& place,
                 const PathNoise& noise) {
  Eigen::MatrixXd white = both;
  const double determinant = whiten(white, place, noise);
  const Eigen::Index k = both.cols() - 1;
  const Eigen::MatrixXd X = left_columns(white, k);
  const Eigen::VectorXd y = white.col(k);
  const Eigen::LLT<Eigen::MatrixXd> N(transposed_product(X, X));
  if (N.info() != Eigen::Success) return INFINITY;
  const Eigen::VectorXd beta = solution(N, transposed_times(X, y));
  const double rss = squared_residual(y, X, beta);
  double log_information = 0.0;
  for (Eigen::Index i = 0; i < k; ++i) log_information += 2.0 * std::log(N.matrixLLT()(i, i));
  return determinant + log_information +
         static_cast<double>(both.rows() - k) * std::log(std::max(rss, 1e-300));
}

}  // namespace

PathNoise path_noise(const Eigen::MatrixXd& X, const Eigen::VectorXd& y,
                     const std::vector<int>& place) {
  const Eigen::MatrixXd both = with_column(X, y);
  PathNoise best;
  double least = criterion(both, place, best);
  const auto attempt = [&](double rho, double w) {
    if (!(rho > 0.0 && rho <= 0.995 && w > 0.0 && w <= 1.0)) return false;
    const double c = criterion(both, place, {rho, w});
    if (!(c < least)) return false;
    least = c, best = {rho, w};
    return true;
  };
  for (const double rho : {0.3, 0.6, 0.85, 0.95})
    for (const double w : {0.3, 1.0}) attempt(rho, w);
  if (best.w == 0.0) return best;
  // Steps of the correlation length and of the odds of w, until no step is an improvement.
  for (double step = 0.8; step > 0.09; step /= 2.0)
    for (bool moved = true; moved;) {
      moved = false;
      for (const double sign : {1.0, -1.0}) {
        const double length = -std::log(best.rho) * std::exp(sign * step);
        moved = attempt(std::exp(-length), best.w) || moved;
        const double odds = (best.w + 1e-3) / (1.0 - best.w + 1e-3) * std::exp(sign * step);
        moved = attempt(best.rho, std::min(1.0, (odds * 1.001 - 1e-3) / (1.0 + odds))) || moved;
      }
    }
  return best;
}

}  // namespace nonio::math
