// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "nonio/math/rotary.h"
#include "nonio/sdk/error.h"

/// The rotary axes of one machine as one chain, from centers of a ball at several positions of all
/// axes: one least-squares fit with exact rotations.
///
///     M = T(q) - H(t)          reading of the linear axes with the probe on the ball
///     T(q) = S_1(S_2(q))       axes that carry the workpiece, from the bed outwards
///     H(t) = S'_1(S'_2(t))     axes that carry the tool, from the bed outwards
///     S(p) = c + R(n, phi)(p - c)
///
/// c, n: point and direction of an axis while all axes are at 0; for a table in the coordinates of
/// the linear axes, with the heads at 0; for a head relative to the tip of the first tool. q:
/// position of a ball at 0, one per ball; t: tip of a tool relative to that of the first one (t =
/// 0) at 0. phi: encoder reading. Its zero is that of these lines; its errors are in the residuals.
///
/// Unknowns of each line: two coordinates of c and two components of n, along the two machine axes
/// most nearly perpendicular to n. Columns of tilts are scaled with the extent of the readings;
/// singular values below `chain_rank` of the largest are treated as 0. A value is identifiable if
/// no combination of unknowns that changes no reading changes it. Derived (docs/dev/estimators.md).
/// Range: one or two axes, coordinates up to 1e6 m, at least some mm of movement.
namespace nonio::math {

inline constexpr double chain_rank = 1e-6;

struct ChainReading {
  Vector3 at{};
  std::vector<double> angle;  ///< angle of each axis of the chain, rad
  double weight = 1.0;        ///< number of readings in the mean, above 0
  std::size_t ball = 0, tool = 0;
};

/// Order of the axes: tables from the bed outwards, then heads from the bed outwards.
struct ChainOrder {
  std::size_t tables = 0, heads = 0;
  std::size_t balls = 1, tools = 1;
  std::size_t axes() const { return tables + heads; }
};

struct ChainLine {
  Vector3 point{}, direction{};
};

struct ChainState {
  std::vector<ChainLine> lines;
  std::vector<Vector3> ball, tool;  ///< positions of balls and tool tips; the first tool is at 0
};

enum class ChainRefusal {
  /// a number that is not finite, a coordinate beyond 1e6 m, a weight not above 0, or a wrong index
  not_finite,
  too_few,  ///< fewer than two readings, no axis, or no degree of freedom
  not_converging,
  ambiguous,  ///< two chains with different directions fit equally well
};

struct ChainFit {
  ChainState state;
  std::vector<Vector3> residual;
  double s = 0.0;
  int dof = 0;  ///< degrees of freedom: three for each reading, minus the rank
  std::size_t unknowns = 0, rank = 0;
  /// singular values of all unknowns, relative to the largest, in descending order
  std::vector<double> singular;
  /// Combinations of unknowns that change no reading, as lists of indices: the four of each line
  /// (point, then direction), three of each ball, three of each tool except the first.
  std::vector<std::vector<std::size_t>> open;
  /// Coordinates in which point and direction of each line are unknown.
  std::vector<std::array<std::size_t, 2>> across;
  /// Derivatives of the unknowns by the readings: x of all readings, then y, then z.
  std::vector<std::vector<double>> by;
  /// Derivatives of the residuals by the readings, in the order of `by`; empty above 200 readings.
  std::vector<std::vector<double>> residual_by;
  /// Residuals along the path on which an axis moves the ball: root mean square in this direction
  /// and in all others, and their degrees of freedom.
  struct Followed {
    double along = 0.0, rest = 0.0, dof_along = 0.0, dof_rest = 0.0;
  };
  std::vector<Followed> followed;

  /// unit vectors of scaled unknowns that change no reading
  std::vector<std::vector<double>> null_space;
  std::vector<double> scale;  ///< factor from each scaled unknown to the unknown
};

tl::expected<ChainFit, ChainRefusal> fit_chain(const std::vector<ChainReading>&, const ChainOrder&);

struct ChainValue {
  double value = 0.0;
  bool identifiable = false;
  std::vector<double> by;  ///< derivatives by the readings, in the order of `ChainFit::by`
};
/// The derivatives are central differences with steps of 1 um and 1 urad.
ChainValue chain_value(const ChainFit&, const std::function<double(const ChainState&)>&);

/// Reading of the linear axes, m, in a state, with the angles, ball and tool of the given reading.
Vector3 chain_reading(const ChainState&, const ChainOrder&, const ChainReading&);

Vector3 nearest_on(const ChainLine&, const Vector3& to);
/// Distance of two lines, m, positive if the second is on the side of (direction of the first) x
/// (direction of the second); never negative for parallel lines. The angle is in rad.
double signed_distance(const ChainLine&, const ChainLine&);
double angle_between(const ChainLine&, const ChainLine&);

}  // namespace nonio::math
