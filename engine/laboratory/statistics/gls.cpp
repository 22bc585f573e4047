// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/gls.h"

#include <cmath>
#include <map>
#include <numbers>

namespace nonio::statistics {

MatrixXd covariance_of(const Series& s) {
  const auto n = static_cast<Index>(s.points.size());
  MatrixXd V = MatrixXd::Zero(n, n);
  std::map<std::string, VectorXd> of_source;
  for (Index i = 0; i < n; ++i) {
    const Point& p = s.points[static_cast<std::size_t>(i)];
    const double u = s.excess * p.u;
    V(i, i) += u * u;
    for (const Common& c : p.common)
      of_source.try_emplace(c.source, VectorXd::Zero(n)).first->second(i) += c.u;
  }
  for (const auto& [source, u] : of_source) V += u * u.transpose();
  return V;
}

Whitened::Whitened(const Series& s) : spread(s.spread), factor(covariance_of(s)) {
  VectorXd values(static_cast<Index>(s.points.size()));
  for (Index i = 0; i < values.size(); ++i) values(i) = s.points[static_cast<std::size_t>(i)].value;
  y = column(values);
}

VectorXd Whitened::column(const VectorXd& x) const {
  VectorXd out = VectorXd::Zero(x.size() + (spread > 0.0 ? 1 : 0));
  out.head(x.size()) = math::whitened(factor, x);
  return out;
}

VectorXd Whitened::slope(const VectorXd& times) const {
  VectorXd out = column(times);
  if (spread > 0.0) out(times.size()) = 1.0 / spread;
  return out;
}

std::optional<Gls> gls(const Whitened& w, const MatrixXd& X) {
  const Eigen::ColPivHouseholderQR<MatrixXd> ranked(X);
  if (ranked.rank() < X.cols() || X.rows() < X.cols()) return std::nullopt;
  const Eigen::HouseholderQR<MatrixXd> qr(X);
  Gls out;
  out.basis = math::orthonormal(qr, X.cols());
  const MatrixXd R = math::upper(qr, X.cols());
  out.b = math::solution_of_upper(R, math::transposed_times(out.basis, w.y));
  const MatrixXd inverse = math::inverse_of_upper(R);
  out.C = math::product_transposed(inverse, inverse);
  out.chi2 = math::orthogonal_part(out.basis, w.y).squaredNorm();
  out.dof = static_cast<double>(X.rows() - X.cols());
  return out;
}

double normal_two_sided(double z) { return std::erfc(std::fabs(z) / std::numbers::sqrt2); }
double normal_upper(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

}  // namespace nonio::statistics
