// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dense.h"
#include "nonio/math/distributions.h"
#include "nonio/math/rotary.h"

namespace nonio::math {
namespace {

using Eigen::Vector3d;

Vector3d vector(const Vector3& v) { return {v[0], v[1], v[2]}; }

double sum_of_squares(std::span<const BallCentre> centres, const std::vector<double>& residual) {
  double sum = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i)
    sum += centres[i].weight * residual[i] * residual[i];
  return sum;
}

Eigen::Matrix<double, 6, 6> covariance(const RotaryFit& fit, double sigma) {
  Eigen::Matrix<double, 6, 6> out;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < 6; ++k)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          fit.cofactor[i][k] * sigma * sigma;
  return out;
}

}  // namespace

DoubleWave double_wave(const RotaryFit& fit, std::span<const BallCentre> centres,
                       const std::vector<double>& residual) {
  constexpr double widest = 2.0 * std::numbers::pi / 3.0 + 1e-6;
  DoubleWave wave;
  wave.left = fit.s;
  const auto n = static_cast<Eigen::Index>(residual.size());
  const int dof = fit.dof - 2;
  if (n < 5 || fit.gap > widest || dof < 1) return wave;
  Eigen::MatrixXd a(n, 5);
  Eigen::VectorXd b(n), root(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double t = fit.around[k];
    a.row(i) << 1.0, std::cos(t), std::sin(t), std::cos(2.0 * t), std::sin(2.0 * t);
    b[i] = residual[k];
    root[i] = std::sqrt(centres[k].weight);
  }
  const Eigen::VectorXd x =
      (root.asDiagonal() * a).eval().colPivHouseholderQr().solve(root.cwiseProduct(b));
  const double own = sum_of_squares(centres, residual);
  const double left = root.cwiseProduct(b - a * x).squaredNorm();
  const double all = fit.s * fit.s * fit.dof;
  const double remains = std::max(0.0, all - own + left);
  wave.amplitude = std::hypot(x[3], x[4]);
  wave.phase = 0.5 * std::atan2(x[4], x[3]);
  wave.left = std::sqrt(remains / dof);
  wave.p = f_upper(test_ratio((own - left) / 2.0, remains / dof), 2.0, dof);
  return wave;
}

long long place_in_turn(double angle) {
  constexpr double turn = 2.0 * std::numbers::pi, resolution = 1e-6;
  const double within = angle - turn * std::floor(angle / turn);
  return std::llround(within / resolution) % std::llround(turn / resolution);
}

std::string other_turning_axis(const Observations& o) {
  constexpr double least = 1e-6;  // smallest motion of an axis, rad
  for (std::size_t k = 1; k < o.axes.size(); ++k) {
    const auto& column = o.axes[k];
    if (!column.rotary || column.position.empty()) continue;
    const auto [low, high] = std::minmax_element(column.position.begin(), column.position.end());
    if (*high - *low > least) return column.axis;
  }
  return {};
}

double expansion_factor(int dof) {
  if (dof < 0) return 2.0;
  if (dof == 0) return std::numeric_limits<double>::quiet_NaN();
  // probability outside k = 2 of a normal distribution
  const double outside = std::erfc(2.0 / std::numbers::sqrt2);
  double low = 2.0, high = 20.0;  // the largest factor, t for one degree of freedom, is 13.97
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (t_two_sided(middle, dof) > outside ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

LineRelation relation_of(const RotaryFit& a, double sigma_a, const RotaryFit& b, double sigma_b) {
  const Vector3d p = vector(a.centre), q = vector(b.centre);
  const Vector3d m = vector(a.direction), n = vector(b.direction);
  const Vector3d cross = m.cross(n);
  const double sine = cross.norm();
  LineRelation out;
  out.angle = std::atan2(sine, m.dot(n));
  Eigen::Matrix<double, 6, 1> da = Eigen::Matrix<double, 6, 1>::Zero(), db = da, ta = da, tb = da;
  if (sine > 1e-6) {
    const Vector3d normal = cross / sine, gap = q - p;
    const double signed_distance = gap.dot(normal);
    const double sign = signed_distance < 0.0 ? -1.0 : 1.0;
    out.distance = sign * signed_distance;
    // The component of the gap perpendicular to the normal turns with the directions.
    const Vector3d across = (gap - signed_distance * normal) / sine;
    da.head<3>() = -sign * normal;
    db.head<3>() = sign * normal;
    da.tail<3>() = sign * n.cross(across);
    db.tail<3>() = sign * across.cross(m);
    ta.tail<3>() = (m * m.dot(n) - n) / sine;
    tb.tail<3>() = (n * m.dot(n) - m) / sine;
  } else {  // for parallel lines, the distance of a point from the other line
    const Vector3d gap = q - p, across = gap - gap.dot(m) * m;
    out.distance = across.norm();
    const Vector3d unit = out.distance > 0.0 ? Vector3d(across / out.distance) : Vector3d(0, 0, 0);
    da.head<3>() = -unit;
    db.head<3>() = unit;
    da.tail<3>() = -gap.dot(m) * unit;
    // the angle is about 0; any direction perpendicular to m gives its derivative
    ta.tail<3>() = m.unitOrthogonal();
    tb.tail<3>() = -ta.tail<3>();
  }
  const auto ca = covariance(a, sigma_a), cb = covariance(b, sigma_b);
  out.u_distance = std::sqrt(std::max(0.0, da.dot(ca * da) + db.dot(cb * db)));
  out.u_angle = std::sqrt(std::max(0.0, ta.dot(ca * ta) + tb.dot(cb * tb)));
  for (std::size_t i = 0; i < 6; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    out.distance_by_a[i] = da[k], out.distance_by_b[i] = db[k];
    out.angle_by_a[i] = ta[k], out.angle_by_b[i] = tb[k];
  }
  return out;
}

}  // namespace nonio::math
