// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "nonio/math/rotary.h"
#include "nonio/sdk/error.h"

/// Rotary axes of one machine as one chain, from centres of a ball at several positions of all of
/// them: one least-squares fit on exact rotations.
///
///     M = T(q) - H(t)                what the linear axes show with the probe on the ball
///     T(q) = S_1(S_2(q))             axes that carry the workpiece, from the bed outwards
///     H(t) = S'_1(S'_2(t))           axes that carry the tool, from the bed outwards
///     S(p) = c + R(n, phi)(p - c)
///
/// c, n: point and direction of an axis while all of them are at 0; of a table in the coordinates of
/// the linear axes, with the heads at 0; of a head as seen from the tip of the first tool. q: place
/// of a ball at 0, each its own; t: tip of a tool from that of the first one (t = 0) at 0. phi: as
/// the encoder shows it. Its zero is that of these lines; its errors are in the residuals.
///
/// Unknown of each line: two coordinates of c and two components of n, along the two machine axes
/// most nearly across n; three of each q; three of each t but the first. Start: for n along each of
/// the machine axes (and halfway between two of them) the rest is linear; the best of them go on by
/// Gauss-Newton. Columns of tilts are scaled with the extent of the readings; singular values below
/// `chain_rank` of the largest are 0. A value is identifiable if no combination of unknowns that changes no
/// reading changes it.
///
/// Derived (docs/formulas.md); tests compare with exact homogeneous transforms. Range: one or two
/// axes, coordinates up to 1e6 m, at least some mm of movement.
namespace nonio::math {

inline constexpr double chain_rank = 1e-6;

struct ChainReading {
  Vector3 at{};               ///< m
  std::vector<double> angle;  ///< of each axis of the chain, rad
  double weight = 1.0;        ///< readings behind it, above 0
  std::size_t ball = 0, tool = 0;
};

/// The chain: tables from the bed outwards, then heads from the bed outwards.
struct ChainOrder {
  std::size_t tables = 0, heads = 0;
  std::size_t balls = 1, tools = 1;
  std::size_t axes() const { return tables + heads; }
};

struct ChainLine {
  Vector3 point{}, direction{};
};

/// The unknowns.
struct ChainState {
  std::vector<ChainLine> lines;     ///< in the order of the chain
  std::vector<Vector3> ball, tool;  ///< tool: the first is 0
};

enum class ChainRefusal {
  not_finite,      ///< a coordinate or angle that is none, or beyond 1e6 m; a weight not above 0
  too_few,         ///< no degree of freedom
  not_converging,  ///< no start leads to an end
  ambiguous,       ///< two chains with other directions fit alike
};

struct ChainFit {
  ChainState state;
  std::vector<Vector3> residual;
  double s = 0.0;
  int dof = 0;  ///< three for each reading, less the rank
  std::size_t unknowns = 0, rank = 0;
  std::vector<double> singular;  ///< of all unknowns, relative to the largest, falling
  /// Unknowns that change no reading together, as numbers: the four of each line (point, then
  /// direction), three of each ball, three of each tool but the first.
  std::vector<std::vector<std::size_t>> open;
  /// Coordinates along which point and direction of a line are unknown.
  std::vector<std::array<std::size_t, 2>> across;
  /// Derivatives of the unknowns by the readings: x of all of them, then y, then z.
  std::vector<std::vector<double>> by;
  /// The same of the residuals, x of all, then y, then z; empty above 200 readings.
  std::vector<std::vector<double>> residual_by;
  /// Residuals along the way on which an axis moves the ball: root of the mean square there and in
  /// all other directions, and their degrees of freedom.
  struct Followed {
    double along = 0.0, rest = 0.0, dof_along = 0.0, dof_rest = 0.0;
  };
  std::vector<Followed> followed;  ///< of each axis

  std::vector<std::vector<double>> null_space;  ///< unit vectors, scaled unknowns
  std::vector<double> scale;                    ///< of the unknowns
};

tl::expected<ChainFit, ChainRefusal> fit_chain(const std::vector<ChainReading>&, const ChainOrder&);

/// A value that depends on the unknowns.
struct ChainValue {
  double value = 0.0;
  bool identifiable = false;
  std::vector<double> by;  ///< derivatives by the readings, as in `ChainFit::by`
};
/// Derivatives by central differences of 1 um and 1 urad.
ChainValue chain_value(const ChainFit&, const std::function<double(const ChainState&)>&);

/// What the linear axes would show.
Vector3 chain_reading(const ChainState&, const ChainOrder&, const ChainReading&);

/// The point of a line nearest to another point.
Vector3 nearest_on(const ChainLine&, const Vector3& to);
/// Distance of two lines, positive if the second is on the side of the first's direction x its own;
/// of parallel ones never negative. And the angle between their directions, rad.
double signed_distance(const ChainLine&, const ChainLine&);
double angle_between(const ChainLine&, const ChainLine&);

}  // namespace nonio::math
