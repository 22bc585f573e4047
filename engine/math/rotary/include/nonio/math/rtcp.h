// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "nonio/math/rotary.h"
#include "nonio/sdk/error.h"

/// Errors of a control's rotary axis, from readings with tool center point control (RTCP, TRAORI,
/// M128): position of the tool relative to the workpiece, minus the commanded one.
///
///     control   point c0, direction n0: circle of the commanded positions of the linear axes
///     machine   point c = c0 + a e1 + b e2, direction n = n0 + p e1 + q e2 + r e3, |n| = 1
///     moved     M(t) = c + R(n, t)(B + d - c) - c0 - R(n0, t)(B - c0)
///     reading   y = -s.M(t) + z (a table carries the workpiece) or +s.M(t) + z (a head, the tool)
///
/// B: position of the ball with the axis at 0 in the control; d: distance of the ball from there,
/// unknown unless stated; s: direction of sensing; z: zero of the gauge, unknown except for a
/// probe; e1, e2: the two machine axes most nearly perpendicular to the rotary axis. a, b, p, q are
/// identifiable if their unit vectors are in the row space of the Jacobian at the axis of the
/// control; a fixed gauge determines a and b only together with d. Derived
/// (docs/dev/estimators.md). Range: errors up to some mm and mrad.
namespace nonio::math {

struct RtcpReading {
  double angle = 0.0;
  Vector3 at{};     ///< commanded positions of X, Y, Z, m
  Vector3 sense{};  ///< direction of sensing, unit vector
  double deviation = 0.0;
  std::size_t line = 0;   ///< index of the line; readings of one line share a zero
  bool has_zero = false;  ///< whether the zero is known, as that of a probe
};

enum class RtcpRefusal {
  /// the commanded positions follow a circle in no line, or with a head not in every line
  none_go_round,
  /// commanded positions differ from the control's circle by more than `rtcp_circle`
  not_a_circle,
  disagree,  ///< the commanded positions of lines turn about different axes
};
/// Tolerance for commanded positions, which are exact except for the rounding of the display; m.
inline constexpr double rtcp_circle = 20e-6;

struct RtcpWish {
  bool head = false;        ///< whether the axis carries the tool
  bool ball_known = false;  ///< whether d is 0, within its stated uncertainty
};

struct RtcpFit {
  Vector3 point{}, direction{};             ///< axis of the control; a and b are valid at `point`
  std::array<std::size_t, 2> across{0, 1};  ///< coordinates of e1, e2
  std::array<double, 4> value{};            ///< a, b: m; p, q: rad
  std::array<bool, 4> identifiable{};
  std::array<bool, 4> identifiable_with_ball{};
  /// Derivatives of a, b, p, q by the readings.
  std::array<std::vector<double>, 4> by{};
  std::vector<double> residual;
  /// Derivatives of each residual by the readings; empty above 1000 readings.
  std::vector<std::vector<double>> residual_by;
  /// Change of each reading per 1 m of the ball's position along X, Y and Z, with the axis at 0.
  std::array<std::vector<double>, 3> by_ball{};
  std::vector<std::size_t> ball;  ///< index of the ball of each line
  std::vector<Vector3> place;     ///< position of each ball in the control, with the axis at 0
  int dof = 0;
  double s = 0.0;  ///< standard deviation of a reading from the residuals; 0 if dof is 0
};

/// The readings may be in any order and must contain at least one line.
tl::expected<RtcpFit, RtcpRefusal> fit_rtcp(const std::vector<RtcpReading>&, const RtcpWish&);

}  // namespace nonio::math
