// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"

/// Quantities of readings in space, from which effects compute their columns. An effect defines the
/// error vector e of the tool point at (x, y, z), in m from the corner of the measured volume; a
/// reading senses n . e, with n the unit vector of its line, so that a column is
///
///     column_i = sum over k of n_k(i) de_k/dparameter (x_i, y_i, z_i)
///
/// Chain bed - X - Y - Z - tool, right-handed; see docs/conventions.md:
///
///          Z   Y
///          |  /    corner: the lowest measured position of each axis
///          | /     lever of an angle about k: the coordinates across k, from the corner
///   corner +------ X
namespace nonio {

/// Positions of the tool point relative to the corner, which is the lowest measured position of
/// each axis.
struct SpaceReadings {
  /// x, y, z of each reading from the corner of the measured volume, m; NaN if the position of the
  /// axis is not stated. A coordinate that no axis has is empty. k is 0, 1, 2 for x, y, z.
  std::array<std::vector<double>, 3> r;
  std::array<double, 3> length{};  ///< size of the measured volume along x, y, z, m

  bool moves(std::size_t k) const { return length[k] > 0.0; }
  /// Returns coordinate k of reading i from the corner, m: 0 if it is not stated.
  double lever(std::size_t k, std::size_t i) const {
    return r[k].empty() || !std::isfinite(r[k][i]) ? 0.0 : r[k][i];
  }
};

/// Returns the positions relative to the corner, computed from the commanded positions of the
/// readings; NaN for a coordinate that is not stated.
SpaceReadings space_of(const Observations& o);

/// Returns whether the readings are the centers of a ball that turns with a rotary axis: they are
/// lengths, measured over an angle.
bool of_ball_centres(const Observations& o);

/// Returns whether coordinate k varies within a line whose readings sense direction `error`. If it
/// does not, the zero of each line absorbs everything that depends on k. If `away` is set, only
/// readings whose coordinate `*away` is above that of the corner are considered.
bool varies_where_sensed(const Observations& o, const SpaceReadings& s, std::size_t k,
                         std::size_t error, std::optional<std::size_t> away = std::nullopt);

/// Returns the distinct measured positions of coordinate k, ascending, m from the corner. Positions
/// closer than 1e-9 of the length are one.
std::vector<double> places_of(const SpaceReadings& s, std::size_t k);

/// Returns numbers of knots to try for a smooth curve: from 3 to at most 10, with at least two
/// places for each free value, so that the curve cannot follow single places. Empty for fewer than
/// 8 places.
std::vector<double> knots_over(const std::vector<double>& places);

/// The readings of one line in space. Readings for which other coordinates are stated than for the
/// first reading are omitted.
struct SpaceLine {
  using Vector = std::array<double, 3>;
  std::vector<std::size_t> rows;
  std::vector<Vector> way;  ///< vector from the first row to each row, m
  /// direction of sensing of the first row; longest vector in `way`, m
  Vector sense{}, farthest{};
  double length = 0.0;  ///< length of `farthest`, m
  /// whether all points are on one straight line, up to the rounding of files
  bool straight = true;

  static double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  static Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  /// Returns whether the line is a step diagonal: it moves both perpendicular to the direction of
  /// sensing (along the flat mirror) and along it.
  bool is_stepwise() const { return !straight && std::fabs(dot(farthest, sense)) > 0.5 * length; }
};

/// Returns the line with index `line` into Observations::lines.
SpaceLine space_line(const Observations& o, const SpaceReadings& s, std::size_t line);

std::vector<double> finite_or_zero(std::vector<double> x);

/// Convert a coordinate index to its letter, and a letter to its index (3 if it is no coordinate).
inline char letter_of(std::size_t k) { return "XYZ"[k]; }
inline std::size_t coordinate_of(char letter) {
  return coordinate_of(std::string_view(&letter, 1));
}

}  // namespace nonio
