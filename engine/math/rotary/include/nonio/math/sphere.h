// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "nonio/sdk/error.h"

/// The center of a ball from points touched by a probe.
///
///     start   2 c.P + (r^2 - |c|^2) = |P|^2, linear least squares in c and the bracket
///     fit     Gauss-Newton on e_i = |P_i - c| - r with J = [-(P_i - c)/|P_i - c|, -1]; with a
///             stated radius without the last column
///     cov     s^2 (J'J)^-1, s^2 = sum e^2 / dof, dof = N - 4, or N - 3 with a stated radius
///
/// P_i touched point (center of the stylus), c center, r radius of ball and stylus together, m.
/// Source: A. B. Forbes, Least-squares best-fit geometric elements, NPL Report DITC 140/89 (1991).
/// The scatter must be much smaller than the radius.
namespace nonio::math {

struct SphereFit {
  std::array<double, 3> centre{};
  double radius = 0.0;
  std::array<double, 3> cofactor{};  ///< variance of each coordinate of the center for s = 1 m
  double rss = 0.0;                  ///< residual sum of squares, m^2
  int dof = 0;
  std::vector<double> residual;
};

/// `radius`: stated radius, m. Errors: too few points, points in one plane or on too small a cap,
/// coordinates that are not finite or beyond 1e6 m.
Expected<SphereFit> fit_sphere(std::span<const std::array<double, 3>> touches,
                               std::optional<double> radius = std::nullopt);

}  // namespace nonio::math
