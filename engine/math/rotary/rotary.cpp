// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/rotary.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/constants.h"
#include "dense.h"

namespace nonio::math {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double thinnest = 1e-6;    // smallest ratio of second to first singular value of a plane
constexpr double same_angle = 1e-6;  // smallest difference of two angles of the axis, rad
// Largest rms difference between encoder and circle, rad: docs/dev/constants.md, A9.
constexpr double worst_follow = 0.1;

double wrapped(double angle) { return std::remainder(angle, full_turn); }

std::optional<RotaryRefusal> bad_input(std::span<const BallCentre> centres) {
  std::vector<double> angles;
  for (const BallCentre& c : centres) {
    const double size = std::max({std::fabs(c.at[0]), std::fabs(c.at[1]), std::fabs(c.at[2])});
    if (!(size <= largest_coordinate) || !std::isfinite(c.angle) ||
        std::isnan(c.at[0] + c.at[1] + c.at[2]))
      return RotaryRefusal::not_finite;
    if (!(c.weight > 0.0) || !std::isfinite(c.weight)) return RotaryRefusal::weight;
    angles.push_back(c.angle - full_turn * std::floor(c.angle / full_turn));
  }
  std::sort(angles.begin(), angles.end());
  for (std::size_t i = 0; i + 1 < angles.size(); ++i)
    if (angles[i + 1] - angles[i] < same_angle) return RotaryRefusal::repeated_angles;
  if (angles.size() > 1 && angles.front() + full_turn - angles.back() < same_angle)
    return RotaryRefusal::repeated_angles;
  if (centres.size() < 3) return RotaryRefusal::too_few;
  return {};
}

/// The points in the coordinate system of their plane: e1, e2, n are the columns of `axes`.
struct Plane {
  Vector3d origin;
  Matrix3d axes;
  Points flat;
  Eigen::VectorXd weight;
};

std::optional<Plane> plane_of(std::span<const BallCentre> centres) {
  const auto n = static_cast<Eigen::Index>(centres.size());
  Plane plane;
  plane.weight.resize(n);
  Points points(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const BallCentre& c = centres[static_cast<std::size_t>(i)];
    points.row(i) << c.at[0], c.at[1], c.at[2];
    plane.weight[i] = c.weight;
  }
  // Subtracting the first point before the mean preserves precision if the offset is large.
  const Vector3d first = points.row(0).transpose();
  points.rowwise() -= first.transpose();
  const Vector3d mean = points.transpose() * plane.weight / plane.weight.sum();
  points.rowwise() -= mean.transpose();
  plane.origin = first + mean;
  const Points weighted = plane.weight.cwiseSqrt().asDiagonal() * points;
  // R has the singular values and right singular vectors of the whole matrix.
  const MatrixXd small = upper(Eigen::HouseholderQR<MatrixXd>(weighted), 3);
  const Eigen::JacobiSVD<MatrixXd> svd(small, Eigen::ComputeFullV);
  const auto& size = svd.singularValues();
  if (!(size[1] > thinnest * size[0]) || !(size[0] > 1e-12 * (1.0 + plane.origin.norm())))
    return {};
  plane.axes = svd.matrixV();
  if (plane.axes.determinant() < 0.0) plane.axes.col(2) = -plane.axes.col(2);
  plane.flat = points * plane.axes;
  return plane;
}

/// `cofactor`: covariance for a standard uncertainty of 1 m; `shear_shift`: see RotaryFit.
struct Circle {
  Vector2d centre = Vector2d::Zero();
  double radius = 0.0;
  Matrix2d cofactor = Matrix2d::Zero();
  double cofactor_radius = 0.0;
  double shear_shift = 0.0;
};

/// The fit of Kasa is exact for points on a circle, and biased inwards on short arcs with noise.
std::optional<Circle> kasa(const Plane& p) {
  Points a(p.flat.rows(), 3);
  a << 2.0 * p.flat.col(0), 2.0 * p.flat.col(1), Eigen::VectorXd::Ones(p.flat.rows());
  const Eigen::VectorXd b = p.flat.col(0).cwiseAbs2() + p.flat.col(1).cwiseAbs2();
  const Eigen::VectorXd root = p.weight.cwiseSqrt();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(scaled_rows(root, a));
  if (qr.rank() < 3) return {};
  const Vector3d x = solution(qr, root.cwiseProduct(b));
  Circle c;
  c.centre = x.head<2>();
  c.radius = std::sqrt(x[2] + c.centre.squaredNorm());
  if (!std::isfinite(c.radius)) return {};
  return c;
}

double largest_singular(const Matrix2d& m) {
  return 0.5 * (std::hypot(m(0, 0) + m(1, 1), m(0, 1) - m(1, 0)) +
                std::hypot(m(0, 0) - m(1, 1), m(0, 1) + m(1, 0)));
}

std::optional<Circle> geometric(const Plane& p) {
  constexpr int most_steps = 100;
  auto c = kasa(p);
  if (!c) return {};
  const Eigen::Index n = p.flat.rows();
  Points J(n, 3);
  Eigen::VectorXd r(n);
  for (int step = 0; step < most_steps; ++step) {
    Matrix3d normal = Matrix3d::Zero(), spread = Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector2d d = p.flat.row(i).head<2>().transpose() - c->centre;
      const double rho = d.norm();
      if (!(rho > 0.0)) return {};
      const Vector3d g(-d[0] / rho, -d[1] / rho, -1.0);
      normal += p.weight[i] * g * g.transpose();
      right -= p.weight[i] * g * (rho - c->radius);
      // Radial displacement per unit of shear: R/2 cos 2t and R/2 sin 2t.
      const double cos2 = g[0] * g[0] - g[1] * g[1], sin2 = 2.0 * g[0] * g[1];
      spread.col(0) -= p.weight[i] * g * (0.5 * c->radius * cos2);
      spread.col(1) -= p.weight[i] * g * (0.5 * c->radius * sin2);
    }
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(normal);
    if (!qr.isInvertible()) return {};
    const Vector3d delta = solution(qr, right);
    c->centre += delta.head<2>();
    c->radius += delta[2];
    if (!(c->radius > 0.0) || !(c->radius < largest_coordinate)) return {};
    if (!(delta.cwiseAbs().maxCoeff() > 1e-11 * c->radius)) {
      const Matrix3d inverse = math::inverse(qr);
      c->cofactor = inverse.topLeftCorner<2, 2>();
      c->cofactor_radius = inverse(2, 2);
      c->shear_shift = largest_singular((inverse * spread).topLeftCorner<2, 2>());
      return c;
    }
  }
  return {};
}

/// Sense of the points about the normal relative to the encoder, and angle of the point at encoder
/// zero. `sense_of` returns std::nullopt if neither sense agrees to within `worst_follow`.
struct Sense {
  double sign = 1.0, zero = 0.0;
};
std::optional<Sense> sense_of(std::span<const BallCentre> centres, const Plane& p,
                              const Vector2d& centre) {
  Sense best;
  double least = worst_follow * worst_follow;
  bool found = false;
  for (const double sign : {1.0, -1.0}) {
    Vector2d sum = Vector2d::Zero();
    std::vector<double> seen;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      seen.push_back(std::atan2(p.flat(k, 1) - centre[1], p.flat(k, 0) - centre[0]) -
                     sign * centres[i].angle);
      sum += p.weight[k] * Vector2d(std::cos(seen.back()), std::sin(seen.back()));
    }
    const double zero = std::atan2(sum[1], sum[0]);
    double square = 0.0;
    for (std::size_t i = 0; i < seen.size(); ++i)
      square += p.weight[static_cast<Eigen::Index>(i)] * std::pow(wrapped(seen[i] - zero), 2);
    square /= p.weight.sum();
    if (square < least) least = square, best = {sign, zero}, found = true;
  }
  if (!found) return {};
  return best;
}

Circle with_angles(std::span<const BallCentre> centres, const Plane& p, double sign) {
  using Matrix4d = Eigen::Matrix4d;
  using TwoRows = Eigen::Matrix<double, 2, 4>;
  Matrix4d normal = Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  const auto row = [&](std::size_t i) {
    const double cosine = std::cos(centres[i].angle), sine = sign * std::sin(centres[i].angle);
    TwoRows g;
    g << 1.0, 0.0, cosine, -sine, 0.0, 1.0, sine, cosine;
    return g;
  };
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const TwoRows g = row(i);
    normal += p.weight[k] * g.transpose() * g;
    right += p.weight[k] * g.transpose() * p.flat.row(k).head<2>().transpose();
  }
  const Matrix4d inverse = normal.inverse();
  const Eigen::Vector4d x = inverse * right;
  Circle c;
  c.centre = x.head<2>();
  const Vector2d arm = x.tail<2>();
  c.radius = arm.norm();
  c.cofactor = inverse.topLeftCorner<2, 2>();
  c.cofactor_radius = inverse(2, 2);
  // Displacement per unit of shear: half of (u, -v) and of (v, u) about the center.
  Eigen::Matrix<double, 4, 2> spread = Eigen::Matrix<double, 4, 2>::Zero();
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const TwoRows g = row(i);
    const Vector2d d = g.rightCols<2>() * arm;
    Matrix2d moved;
    moved << d[0], d[1], -d[1], d[0];
    spread += p.weight[static_cast<Eigen::Index>(i)] * g.transpose() * (0.5 * moved);
  }
  c.shear_shift = largest_singular((inverse * spread).topRows<2>());
  return c;
}

void put_residuals(RotaryFit& fit, std::span<const BallCentre> centres, const Plane& p,
                   const Circle& c, const Sense& sense, bool use_angles) {
  double sum = 0.0;
  std::vector<double> around;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Vector2d d = p.flat.row(k).head<2>().transpose() - c.centre;
    const double at = std::atan2(d[1], d[0]);
    fit.radial.push_back(d.norm() - c.radius);
    fit.axial.push_back(sense.sign * p.flat(k, 2));
    fit.tangential.push_back(c.radius * sense.sign *
                             wrapped(at - sense.sign * centres[i].angle - sense.zero));
    around.push_back(sense.sign * (at - sense.zero));
    const double t = use_angles ? fit.tangential.back() : 0.0;
    sum += p.weight[k] * (std::pow(fit.radial.back(), 2) + std::pow(fit.axial.back(), 2) + t * t);
  }
  const int n = static_cast<int>(centres.size());
  fit.dof = use_angles ? 3 * n - 7 : 2 * n - 6;
  fit.s = fit.dof > 0 ? std::sqrt(sum / fit.dof) : 0.0;
  fit.around = around;
  for (double& a : around) a -= full_turn * std::floor(a / full_turn);
  std::sort(around.begin(), around.end());
  fit.gap = around.front() + full_turn - around.back();
  for (std::size_t i = 0; i + 1 < around.size(); ++i)
    fit.gap = std::max(fit.gap, around[i + 1] - around[i]);
}

void put_covariance(RotaryFit& fit, const Plane& p, const Circle& c) {
  Points G = p.flat;
  G.col(2).setOnes();
  const Matrix3d cp = (G.transpose() * p.weight.asDiagonal() * G).inverse();
  // Covariance of (a, b, height at the center, slope along e1, slope along e2).
  const Vector3d g(c.centre[0], c.centre[1], 1.0);
  Eigen::Matrix<double, 5, 5> inner = Eigen::Matrix<double, 5, 5>::Zero();
  inner.topLeftCorner<2, 2>() = c.cofactor;
  inner(2, 2) = g.dot(cp * g);
  inner.block<2, 1>(3, 2) = (cp * g).head<2>();
  inner.block<1, 2>(2, 3) = inner.block<2, 1>(3, 2).transpose();
  inner.bottomRightCorner<2, 2>() = cp.topLeftCorner<2, 2>();
  Eigen::Matrix<double, 6, 5> out = Eigen::Matrix<double, 6, 5>::Zero();
  out.topLeftCorner<3, 3>() = p.axes;
  const double sign =
      p.axes.col(2).dot(Vector3d(fit.direction[0], fit.direction[1], fit.direction[2])) > 0.0
          ? 1.0
          : -1.0;
  out.bottomRightCorner<3, 2>() = -sign * p.axes.leftCols<2>();
  const Matrix6d all = out * inner * out.transpose();
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < 6; ++k)
      fit.cofactor[i][k] = all(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
  fit.cofactor_radius = c.cofactor_radius;
  fit.shear_shift = c.shear_shift;
}

}  // namespace

tl::expected<RotaryFit, RotaryRefusal> fit_rotary(std::span<const BallCentre> centres,
                                                  bool use_angles) {
  if (const auto bad = bad_input(centres)) return tl::unexpected(*bad);
  const auto plane = plane_of(centres);
  if (!plane) return tl::unexpected(RotaryRefusal::collinear);
  auto circle = geometric(*plane);
  if (!circle) return tl::unexpected(RotaryRefusal::not_converging);
  auto sense = sense_of(centres, *plane, circle->centre);
  if (!sense) return tl::unexpected(RotaryRefusal::angles_disagree);
  if (use_angles) {
    circle = with_angles(centres, *plane, sense->sign);
    sense = sense_of(centres, *plane, circle->centre);
    if (!sense) return tl::unexpected(RotaryRefusal::angles_disagree);
  }
  RotaryFit fit;
  const Vector3d centre = plane->origin + plane->axes.leftCols<2>() * circle->centre;
  const Vector3d direction = sense->sign * plane->axes.col(2);
  for (std::size_t k = 0; k < 3; ++k) {
    fit.centre[k] = centre[static_cast<Eigen::Index>(k)];
    fit.direction[k] = direction[static_cast<Eigen::Index>(k)];
  }
  fit.radius = circle->radius;
  put_residuals(fit, centres, *plane, *circle, *sense, use_angles);
  put_covariance(fit, *plane, *circle);
  return fit;
}

}  // namespace nonio::math
