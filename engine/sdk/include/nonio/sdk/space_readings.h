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

/// What effects in space are made of. An effect gives the error vector e of the tool point at
/// (x, y, z), in m from the corner of the measured volume; a reading senses n . e, n the unit
/// vector of its line, so that a column is
///
///     column_i = sum over k of n_k(i) de_k/dparameter (x_i, y_i, z_i)
///
/// Chain bed - X - Y - Z - tool, right-handed; docs/conventions.md draws it:
///
///              Z   Y
///              |  /       corner: the lowest measured position of each axis
///              | /        lever of an angle about k: the coordinates across k, from the corner
///       corner +------ X
namespace nonio {

/// Where the tool point was. The corner is the lowest measured position of each axis.
struct SpaceReadings {
  /// x, y, z of each reading from the corner of the measured volume, m; NaN where the position of
  /// the axis is not stated. A coordinate that no axis has is empty. k is 0, 1, 2 for x, y, z.
  std::array<std::vector<double>, 3> r;
  std::array<double, 3> length{};  ///< of the measured volume, m

  bool moves(std::size_t k) const { return length[k] > 0.0; }
  /// Distance of a point from the corner: 0 where it is not stated.
  double lever(std::size_t k, std::size_t i) const {
    return r[k].empty() || !std::isfinite(r[k][i]) ? 0.0 : r[k][i];
  }
};

/// From commanded positions of the readings. No errors: coordinates that are not stated are NaN.
SpaceReadings space_of(const Observations& o);

/// Centres of a ball that turns with a rotary axis: lengths over an angle.
bool of_ball_centres(const Observations& o);

/// Whether coordinate k changes within a line whose readings sense direction `error`: else its zero
/// takes whatever depends on k. `away`: looks only at readings that are away from the corner along
/// this coordinate.
bool varies_where_sensed(const Observations& o, const SpaceReadings& s, std::size_t k,
                         std::size_t error, std::optional<std::size_t> away = std::nullopt);

/// The measured positions of coordinate k, each once, ascending, m from the corner. Positions
/// nearer than 1e-9 of the length are one.
std::vector<double> places_of(const SpaceReadings& s, std::size_t k);

/// Numbers of knots for a smooth curve: at most 10, and at least two places for each free value, so
/// that it cannot follow single places.
std::vector<double> knots_over(const std::vector<double>& places);

/// The readings of one line, as it goes through space; without those that do not know where an axis
/// was that the first one knows.
struct SpaceLine {
  using Vector = std::array<double, 3>;
  std::vector<std::size_t> rows;
  std::vector<Vector> way;     ///< of each row from the first one, m
  Vector sense{}, farthest{};  ///< of the first row; the longest way
  double length = 0.0;         ///< of that
  bool straight = true;        ///< all on one straight, but for what files round

  static double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  static Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  /// A step diagonal: aside from the direction of sensing, where a flat mirror is, and along it.
  bool is_stepwise() const { return !straight && std::fabs(dot(farthest, sense)) > 0.5 * length; }
};

/// Of line `line`, an index into Observations::lines.
SpaceLine space_line(const Observations& o, const SpaceReadings& s, std::size_t line);

/// What is not finite becomes 0.
std::vector<double> finite_or_zero(std::vector<double> x);

/// Letter of a coordinate, and back: 3 if it is none.
inline char letter_of(std::size_t k) { return "XYZ"[k]; }
inline std::size_t coordinate_of(char letter) {
  return coordinate_of(std::string_view(&letter, 1));
}

}  // namespace nonio
