// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"

/// The line of a rotary axis from centers of a ball that turns with it.
///
///     plane    weighted centroid m; direction n = right singular vector of the smallest singular
///              value of sqrt(w)(P - m); u, v, h: coordinates along e1, e2, n
///     circle   start: [2u 2v 1][a b r0]' = u^2 + v^2 (Kasa); Gauss-Newton on rho_i - r with
///              J = [-cos t, -sin t, -1], rho_i and t_i: polar coordinates of point i about (a, b)
///     angles   alternative, if the encoder is trusted: (u, v)_i = (a, b) + R(phi_i)(c, d), linear
///     cov      circle s^2 (J'WJ)^-1; plane s^2 (G'WG)^-1, G = [u v 1]; along n at the center
///              g'(G'WG)^-1 g, g = (a, b, 1). Plane and circle decouple to first order.
///     s^2      sum w(h^2 + r^2)/(2N - 6); with angles sum w(h^2 + r^2 + t^2)/(3N - 7)
///
/// Symbols: P_i center of the ball, m; phi_i angle of the axis, rad; w_i weight (1 = one reading);
/// h, r, t: residuals along the axis, radial, tangential, m; N places. Sources: Chernov, Circular
/// and Linear Regression (2010), 5 and 6 (Kasa, Gauss-Newton, covariance); the rest is derived in
/// docs/formulas.md. Range: coordinates up to 1e6 m; equal accuracy of x, y, z; sigma much smaller
/// than the radius. On arcs below about 60 deg the linear covariance is too small; compare its size
/// with the tolerance.
namespace nonio::math {

using Vector3 = std::array<double, 3>;

struct BallCentre {
  Vector3 at{};         ///< position of the center, m
  double angle = 0.0;   ///< angle of the rotary axis, rad
  double weight = 1.0;  ///< number of readings in the mean, above 0
};

enum class RotaryRefusal {
  not_finite,       ///< a coordinate or angle is not finite, or a coordinate is beyond 1e6 m
  weight,           ///< a weight is not above 0 or not finite
  repeated_angles,  ///< two centers have the same angle within a turn; average them first
  too_few,          ///< fewer than three centers
  collinear,        ///< the centers are at one point or on one line, so that no plane is determined
  not_converging,   ///< the fit of a circle in the plane fails or does not converge
  angles_disagree,  ///< the points do not follow the encoder: wrong order, sign or measurement
};

struct RotaryFit {
  Vector3 centre{}, direction{};  ///< positive angles turn right-handed about the direction
  double radius = 0.0;
  /// Covariance of center (0..2) and direction (3..5) for a standard uncertainty of a coordinate of
  /// 1 m.
  std::array<std::array<double, 6>, 6> cofactor{};
  double cofactor_radius = 0.0;
  double s = 0.0;  ///< standard deviation of a coordinate from the residuals; 0 if dof is 0
  int dof = 0;
  std::vector<double> radial, axial, tangential;  ///< residuals, m
  std::vector<double> around;                     ///< angle of each point about the direction, rad
  double gap = 0.0;  ///< largest angle between adjacent points; the arc is 2 pi - gap
  /// Shift of the center by a squareness or scale error of the linear axes that measure it, m per
  /// (m/m) of shear, for the worst orientation; 0 for N > 3 equal steps of a full turn.
  double shear_shift = 0.0;
};

tl::expected<RotaryFit, RotaryRefusal> fit_rotary(std::span<const BallCentre> centres,
                                                  bool use_angles);

/// A wave with two periods per turn in the residuals: a cos 2t + b sin 2t, fitted together with the
/// terms that the circle (or plane) absorbs: constant, cos t, sin t.
struct DoubleWave {
  double amplitude = 0.0;
  double phase = 0.0;  ///< angle of a maximum, rad
  double p = 1.0;     ///< p-value of the hypothesis that no wave exists (F test with 2 and dof - 2)
  double left = 0.0;  ///< standard deviation of all residuals that remain, radial and axial
};
/// Fits the wave to `residual`, which is radial or axial of `fit`. It requires at least five
/// places, dof of at least 3, and no gap of more than 120 deg; otherwise p is 1.
DoubleWave double_wave(const RotaryFit& fit, std::span<const BallCentre> centres,
                       const std::vector<double>& residual);

/// Returns the name of a second rotary axis that moved while ball centers were measured; empty if
/// there is none.
std::string other_turning_axis(const Observations&);

/// Returns the position of a rotary axis within a turn, rounded to an integer number of
/// microradians. Positions with the same number are the same place.
long long place_in_turn(double angle);

/// Returns the coverage factor of a standard uncertainty for 95.45 %: from Student's t for dof
/// above 0, 2 for dof < 0 (known sigma), and NaN for 0.
double expansion_factor(int dof);

/// Relation of two lines in one frame, through p and q along m and n: their shortest distance, and
/// the angle between their directions. Derived (docs/formulas.md).
///
///     distance = |(q - p).(m x n)| / |m x n|     angle = atan2(|m x n|, m.n)
struct LineRelation {
  double distance = 0.0, u_distance = 0.0;  ///< shortest distance and its u, m
  double angle = 0.0, u_angle = 0.0;        ///< angle between the directions and its u, rad
  /// Derivatives by center (0..2) and direction (3..5) of each line.
  std::array<double, 6> distance_by_a{}, distance_by_b{}, angle_by_a{}, angle_by_b{};
};
/// Computes the relation. sigma_a, sigma_b: standard uncertainty of a coordinate in each fit, m.
/// For parallel lines (sine of the angle at most 1e-6), the distance is that of q from the first
/// line.
LineRelation relation_of(const RotaryFit& a, double sigma_a, const RotaryFit& b, double sigma_b);

}  // namespace nonio::math
