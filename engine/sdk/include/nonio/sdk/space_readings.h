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
/// reading senses n . e, where n is the unit vector of its line. A column is
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
  /// Coordinates k = 0, 1, 2 (x, y, z) of each reading from the corner, m; NaN if the position of
  /// the axis is not stated, and empty if no axis has the coordinate.
  std::array<std::vector<double>, 3> r;
  std::array<double, 3> length{};  ///< size of the measured volume along x, y, z, m

  bool moves(std::size_t k) const { return length[k] > 0.0; }
  /// Coordinate k of reading i from the corner, m; 0 if it is not stated.
  double lever(std::size_t k, std::size_t i) const {
    return r[k].empty() || !std::isfinite(r[k][i]) ? 0.0 : r[k][i];
  }
};

/// The positions are the commanded ones, with NaN for a coordinate that is not stated.
SpaceReadings space_of(const Observations& o);

/// Returns the readings of bodies with positions and directions of sensing in the frame of each
/// body, and no position for all other readings. Of the coordinates, X and Y must be stated.
/// std::nullopt if all bodies have the same rotation about Z (docs/conventions.md), because their
/// own errors are then not separable from those of the machine.
std::optional<Observations> in_bodies(const Observations& o);

/// Returns the same error in the frame of parts that were turned by different angles: of fixture or
/// measuring machine, so not compensable. Of an effect of one axis, all readings must be of parts.
Effect in_frame_of_parts(const Effect& of, Info info);

/// Whether the readings are centers of a ball on a rotary axis: lengths, measured over an angle.
bool of_ball_centres(const Observations& o);

/// Whether coordinate k varies within a line whose readings sense direction `error`. Otherwise the
/// zero of each line is not separable from errors that depend on k. If `away` is set, only readings
/// whose coordinate `*away` is above that of the corner are considered.
bool varies_where_sensed(const Observations& o, const SpaceReadings& s, std::size_t k,
                         std::size_t error, std::optional<std::size_t> away = std::nullopt);

/// Returns the distinct measured positions of coordinate k, ascending, m from the corner. Positions
/// closer than 1e-9 of the length are one.
std::vector<double> places_of(const SpaceReadings& s, std::size_t k);

/// Whether the readings are features of parts.
bool of_parts(const Observations& o);

/// Returns numbers of knots for a smooth curve: from 3 to at most 10, with at least two places per
/// free value, so that the curve cannot follow single places; 2 for 4 or 5 places, which the curve
/// follows closely, so use it only where other readings repeat them. Empty for fewer places.
std::vector<double> knots_over(const std::vector<double>& places);

/// The readings of one line in space. Readings for which other coordinates are stated than for the
/// first reading are omitted.
struct SpaceLine {
  using Vector = std::array<double, 3>;
  std::vector<std::size_t> rows;
  std::vector<Vector> way;  ///< vector from the first row to each row, m
  /// Direction of sensing of the first row, and longest vector in `way`, m.
  Vector sense{}, farthest{};
  double length = 0.0;  ///< length of `farthest`, m
  /// Whether all points are on one straight line, apart from the rounding of files.
  bool straight = true;

  static double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  static Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  /// Whether the line is a step diagonal: sensed across the axes, it moves both along the direction
  /// of sensing and perpendicular to it (along the flat mirror). A plate, whose coordinates are
  /// sensed along the axes, has no mirror.
  bool is_stepwise() const {
    const bool is_oblique =
        std::count_if(sense.begin(), sense.end(), [](double n) { return std::fabs(n) > 1e-3; }) > 1;
    return is_oblique && !straight && std::fabs(dot(farthest, sense)) > 0.5 * length;
  }
};

/// `line` is an index into Observations::lines.
SpaceLine space_line(const Observations& o, const SpaceReadings& s, std::size_t line);

std::vector<double> finite_or_zero(std::vector<double> x);

/// The index is 3 if the letter is no coordinate.
inline char letter_of(std::size_t k) { return "XYZ"[k]; }
inline std::size_t coordinate_of(char letter) {
  return coordinate_of(std::string_view(&letter, 1));
}

}  // namespace nonio
