// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"

/// The line of a rotary axis from centers of a ball that turns with it: a least-squares plane and
/// in it a circle (start by Kasa, then Gauss-Newton) or, if the encoder is trusted, a linear fit at
/// its angles; derivations: docs/dev/estimators.md.
///
///     s^2 = sum w(h^2 + r^2)/(2N - 6); with angles sum w(h^2 + r^2 + t^2)/(3N - 7)
///
/// P_i center of the ball, m; phi_i angle of the axis, rad; w_i weight (1 = one reading); h, r, t:
/// residuals along the axis, radial, tangential, m. Sources: Chernov, Circular and Linear
/// Regression (2010), 5 and 6 (Kasa, Gauss-Newton, covariance); docs/dev/estimators.md. On arcs
/// below about 60 deg the linear covariance is too small.
namespace nonio::math {

using Vector3 = std::array<double, 3>;

struct BallCentre {
  Vector3 at{};
  double angle = 0.0;
  double weight = 1.0;  ///< number of readings in the mean, above 0
};

enum class RotaryRefusal {
  not_finite,  ///< a coordinate or angle is not finite, or a coordinate is beyond 1e6 m
  weight,
  repeated_angles,  ///< two centers have the same angle within a turn; average them first
  too_few,
  collinear,  ///< the centers are at one point or on one line, so that no plane is determined
  not_converging,
  angles_disagree,  ///< the points do not follow the encoder: wrong order, sign or measurement
};

struct RotaryFit {
  Vector3 centre{}, direction{};  ///< positive angles turn right-handed about the direction
  double radius = 0.0;
  /// Covariance of center (0..2) and direction (3..5) for a u of a coordinate of 1 m.
  std::array<std::array<double, 6>, 6> cofactor{};
  double cofactor_radius = 0.0;
  double s = 0.0;  ///< standard deviation of a coordinate from the residuals; 0 if dof is 0
  int dof = 0;
  std::vector<double> radial, axial, tangential;  ///< residuals, m
  std::vector<double> around;                     ///< position of the axis at each point, rad
  double gap = 0.0;  ///< largest angle between adjacent points; the arc is 2 pi - gap
  /// Shift of the center by a squareness or scale error of the linear axes, m per (m/m) of shear,
  /// for the worst orientation; 0 for N > 3 equal steps of a full turn.
  double shear_shift = 0.0;
};

tl::expected<RotaryFit, RotaryRefusal> fit_rotary(std::span<const BallCentre> centres,
                                                  bool use_angles);

/// Wave with two periods per turn in the residuals, fitted together with the terms that the circle
/// (or plane) absorbs: constant, cos t, sin t.
struct DoubleWave {
  double amplitude = 0.0;
  double phase = 0.0;  ///< position of the axis at a maximum, -pi/2 to pi/2, rad
  double p = 1.0;     ///< p-value of the hypothesis that no wave exists (F test with 2 and dof - 2)
  double left = 0.0;  ///< standard deviation of all residuals that remain, radial and axial
};
/// `residual`: radial or axial. p is 1 for under five places, dof below 3, or a gap above 120 deg.
DoubleWave double_wave(const RotaryFit& fit, std::span<const BallCentre> centres,
                       const std::vector<double>& residual);

/// Empty if no second rotary axis moved while ball centers were measured.
std::string other_turning_axis(const Observations&);

/// Returns whole microradians within a turn; positions with the same number are the same place.
long long place_in_turn(double angle);

/// Coverage factor for 95.45 %: Student's t for dof > 0, 2 for dof < 0 (known sigma), NaN for 0.
double expansion_factor(int dof);

/// Shortest distance, m, and angle, rad, of two lines through p and q along m and n:
///
///     distance = |(q - p).(m x n)| / |m x n|     angle = atan2(|m x n|, m.n)
struct LineRelation {
  double distance = 0.0, u_distance = 0.0;
  double angle = 0.0, u_angle = 0.0;
  /// Derivatives by center (0..2) and direction (3..5) of each line.
  std::array<double, 6> distance_by_a{}, distance_by_b{}, angle_by_a{}, angle_by_b{};
};
/// sigma_a, sigma_b: standard uncertainty of a coordinate in each fit, m. For parallel lines (sine
/// of the angle at most 1e-6), the distance is that of q from the first line.
LineRelation relation_of(const RotaryFit& a, double sigma_a, const RotaryFit& b, double sigma_b);

}  // namespace nonio::math
