// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/sphere.h"

#include <cmath>
#include <string>

#include "common/constants.h"
#include "dense.h"

namespace nonio::math {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Largest u of a coordinate of the center, in units of that of a touched point.
constexpr double largest_growth = 20.0;

struct Sphere {
  Vector3d centre;
  double radius;
};

/// `points`: relative to their mean. Returns std::nullopt if they do not determine a sphere.
std::optional<Sphere> start(const MatrixXd& points) {
  MatrixXd columns(points.rows(), 4);
  columns << 2.0 * points, VectorXd::Ones(points.rows());
  const VectorXd squares = points.rowwise().squaredNorm();
  const auto qr = columns.colPivHouseholderQr();
  if (qr.rank() < 4) return std::nullopt;
  const VectorXd x = solution(qr, squares);
  const Vector3d centre = x.head<3>();
  const double square = x(3) + centre.squaredNorm();
  if (!(square > 0.0)) return std::nullopt;
  return Sphere{centre, std::sqrt(square)};
}

/// Returns false if a point coincides with the center.
bool linearise(const MatrixXd& points, const Sphere& s, MatrixXd& J, VectorXd& e) {
  for (Index i = 0; i < points.rows(); ++i) {
    const Vector3d out = points.row(i).transpose() - s.centre;
    const double distance = out.norm();
    if (!(distance > 0.0)) return false;
    e(i) = distance - s.radius;
    J.row(i).head<3>() = -out.transpose() / distance;
    if (J.cols() == 4) J(i, 3) = -1.0;
  }
  return true;
}

}  // namespace

Expected<SphereFit> fit_sphere(std::span<const std::array<double, 3>> touches,
                               std::optional<double> radius) {
  const auto n = static_cast<Index>(touches.size());
  const Index unknowns = radius ? 3 : 4;
  if (n <= unknowns || n < 4)
    return fail("expected at least " + std::to_string(std::max<Index>(unknowns + 1, 4)) +
                " touches for a centre and its uncertainty, found " + std::to_string(n));
  MatrixXd points(n, 3);
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < 3; ++k)
      points(i, k) = touches[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
  if (!(points.cwiseAbs().maxCoeff() <= largest_coordinate) || points.hasNaN())
    return fail("expected coordinates of at most 1000 km, found others");
  const Vector3d mean = points.colwise().mean();
  points.rowwise() -= mean.transpose();
  auto sphere = start(points);
  const char* const not_fixed =
      "the touches do not fix a sphere: they lie in one plane, or on too small a part of the ball";
  if (!sphere) return fail(not_fixed);
  if (radius) sphere->radius = *radius;
  MatrixXd J(n, unknowns);
  VectorXd e(n);
  const double extent = points.cwiseAbs().maxCoeff();
  bool done = false;
  for (int i = 0; i < 100 && !done; ++i) {
    if (!linearise(points, *sphere, J, e)) return fail(not_fixed);
    const VectorXd step = least_squares(J, -e);
    if (!step.allFinite()) return fail(not_fixed);
    sphere->centre += step.head<3>();
    if (!radius) sphere->radius += step(3);
    done = step.norm() <= 1e-13 * extent;
  }
  if (!done || !linearise(points, *sphere, J, e)) return fail(not_fixed);
  const MatrixXd cofactor = inverse(transposed_product(J, J));
  SphereFit fit;
  for (Index k = 0; k < 3; ++k) {
    fit.centre[static_cast<std::size_t>(k)] = sphere->centre(k) + mean(k);
    fit.cofactor[static_cast<std::size_t>(k)] = cofactor(k, k);
    if (!(cofactor(k, k) > 0.0 && cofactor(k, k) <= largest_growth * largest_growth))
      return fail(not_fixed);
  }
  fit.radius = sphere->radius;
  fit.rss = e.squaredNorm();
  fit.dof = static_cast<int>(n - unknowns);
  fit.residual.assign(e.begin(), e.end());
  return fit;
}

}  // namespace nonio::math
