// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "nonio/math/rotary.h"
#include "nonio/sdk/error.h"

/// Errors of a control's rotary axis, from readings while it turns with tool centre point control
/// on (RTCP, TRAORI, M128): the tool against the workpiece, less what was commanded.
///
///     control   point c0, direction n0: from the circle of the commanded places of the linear axes
///     machine   point c = c0 + a e1 + b e2, direction n = n0 + p e1 + q e2 + r e3, |n| = 1
///     moved     M(t) = c + R(n, t)(B + d - c) - c0 - R(n0, t)(B - c0)
///     reading   y = -s.M(t) + z (a table carries the workpiece) or +s.M(t) + z (a head, the tool)
///
/// B: place of the ball with the axis at 0 as the control has it; d: how far the ball is from
/// there, unknown unless stated; s: direction of sensing; z: zero of the gauge, unknown but of a
/// probe; e1, e2: the two machine axes most nearly across the rotary axis, in the order X, Y, Z.
/// Least squares on these exact rotations, by Newton steps with the Jacobian of the control's axis.
/// a, b, p, q are given where they are identifiable: their unit vectors are in the row space of
/// that Jacobian. The rest cancels: with a fixed gauge, a and b are found only together with d; a
/// gauge that turns with the axis does not see d; one gauge across the axis, with one ball, sees no
/// direction. Derived (docs/formulas.md). Range: errors up to some mm and mrad.
namespace nonio::math {

struct RtcpReading {
  double angle = 0.0;  ///< rad
  Vector3 at{};        ///< commanded places of X, Y, Z, m
  Vector3 sense{};     ///< unit vector
  double deviation = 0.0;
  std::size_t line = 0;   ///< readings of one share a zero
  bool has_zero = false;  ///< the zero is known: a probe
};

enum class RtcpRefusal {
  none_go_round,  ///< no line's commanded places go round: the control's axis is not known
  not_a_circle,   ///< commanded places off the control's circle by more than `rtcp_circle`
  disagree,       ///< lines whose commanded places turn about different axes
};
/// Commanded places are exact but for their display; m.
inline constexpr double rtcp_circle = 20e-6;

/// How the readings are evaluated.
struct RtcpWish {
  bool head = false;        ///< the axis carries the tool
  bool ball_known = false;  ///< d is 0, within what is stated
};

struct RtcpFit {
  Vector3 point{}, direction{};             ///< of the control; point: where a and b hold
  std::array<std::size_t, 2> across{0, 1};  ///< coordinates of e1, e2
  std::array<double, 4> value{};            ///< a, b: m; p, q: rad
  std::array<bool, 4> identifiable{};
  std::array<bool, 4>
      identifiable_with_ball{};  ///< would be identifiable if the place of the ball were known
  /// Derivatives of a, b, p, q by the readings.
  std::array<std::vector<double>, 4> by{};
  std::vector<double> residual;
  std::vector<std::vector<double>> residual_by;  ///< of each reading, by the readings
  /// Change of each reading by a step of 1 m of the ball's place along X, Y and Z, with the axis
  /// at 0.
  std::array<std::vector<double>, 3> by_ball{};
  std::vector<std::size_t> ball;  ///< of each line, which ball
  std::vector<Vector3> place;     ///< of each ball, with the axis at 0, as the control has it
  int dof = 0;
  double s = 0.0;  ///< from the residuals; 0 if dof is 0
};

/// Readings in any order; at least one line.
tl::expected<RtcpFit, RtcpRefusal> fit_rtcp(const std::vector<RtcpReading>&, const RtcpWish&);

}  // namespace nonio::math
