// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/math/volume_map.h"
#include "nonio/sdk/error.h"

/// The 21 errors of three linear axes, or some of them, from any mixture of readings.
///
/// Chain bed - X - Y - Z - tool, no tool offset, small errors (ISO 230-1 names); y, z from the middle
/// of the volume:
///
///     e_x = EXX + EXY + EXZ - y ECX + z (EBX + EBY + B0Z) - y C0Y
///     e_y = EYX + EYY + EYZ - z (EAX + EAY + A0Z)
///     e_z = EZX + EZY + EZZ + y EAX
///
/// t = -1..1 over the travel, P_k Legendre polynomials:
///
///     positioning   sum of P_k(t), k = 1..degree     (a constant is the zero of the readings)
///     straightness  sum of P_k(t), k = 2..degree     (a slope is squareness, or of the set-up)
///     angle         sum of P_k(t), k = 1..degree     (a constant is squareness)
///
/// A reading senses n . e; readings of a line share an unknown zero, and half the reversal of the
/// line if it was read from both sides. Further unknowns: of a line read across its travel its
/// slope; of a step diagonal: two tilts of its mirror, and (w x n).(P - Q) theta of each angle
/// theta about w, because the mirror turns with the tool (P: way of the reading from the first, Q:
/// the farthest). A reading of an angle is the angle. Lines may share unknowns: the place of an
/// artefact and of its balls (rigid_artefact.h), the set-up and the error of a square.
///
/// What a certificate states of such an unknown is a reading too, of the set-up alone, with the
/// standard uncertainty that is stated: it counts with its weight, and its uncertainty is in U.
///
/// Columns are scaled so that a size of 1 makes at most 1 somewhere in the volume, unknowns of the
/// set-up taken out, readings divided by the scatter of their group. Singular values below
/// `rank_below` of the largest are 0: those combinations of errors change no reading. A result is
/// given if no such combination changes it; nothing is guessed for the others.
///
/// The scatter of a group (readings of one kind) is estimated with the fit, s^2 = r'r / sum(1 - h)
/// with the leverages h, repeated until it stays (Helmert; Foerstner's simplification).
///
/// Derived; tests compare with exact transforms. docs/formulas.md.
namespace nonio::math {

struct RigidReading {
  Corner at{};         ///< m
  Corner sense{};      ///< unit vector; of an angle all 0
  int way = 0;         ///< +1 or -1 along its line
  double value = 0.0;  ///< m or rad
  double u = 0.0;      ///< of what is stated: standard uncertainty
};

struct RigidLine {
  enum class Kind {
    along,
    across,
    mirror,
    angle,
    point,  ///< a coordinate that the machine probed: no zero of its own
    stated  ///< of unknowns that are shared: no error of the machine
  };
  Kind kind = Kind::along;
  std::size_t of = 0, about = 0;  ///< of an angle: axis that moves, axis of the turn
  std::size_t group = 0;          ///< of the scatter; of what is stated none
  std::vector<RigidReading> readings;
  /// An unknown of the set-up that lines have together, by its number from 0.
  struct Shared {
    std::size_t unknown = 0;
    std::vector<double> of_reading;
  };
  std::vector<Shared> shared{};
  bool own_slope = true;  ///< of a line across its travel
};

/// Degrees of the polynomials that are tried where none is requested.
inline constexpr std::size_t least_degree = 2, most_degree = 8;
inline constexpr double rank_below = 1e-6;

struct RigidWish {
  Corner low{}, high{};             ///< the volume
  std::vector<std::string> errors;  ///< ISO 230-1 names; empty: all of axes that move
  std::size_t degree = 0;           ///< 0: by Schwarz's criterion, 2 to 8
  std::size_t parts = 4;            ///< of the map, between nodes
};

struct RigidValue {
  double value = 0.0, u = 0.0;
  Shares shares;
};

struct RigidCurve {
  std::string name;
  std::size_t axis = 0;
  std::vector<double> position, value, u;  ///< m, of an angle rad
  std::vector<Shares> shares;
};

/// Errors that together change no reading: sizes of their terms, the first one 1. "EYX.3": the
/// part of EYX with P_3.
using Combination = std::vector<std::pair<std::string, double>>;

struct RigidSolution {
  std::size_t degree = 0, unknowns = 0, rank = 0, readings = 0;  ///< without what is stated
  std::vector<double> singular;     ///< relative to the largest, falling, all unknowns
  std::vector<std::string> unseen;  ///< errors of which no reading shows anything
  std::vector<Combination> combinations;
  Combination weakest;               ///< that is still identifiable, by the smallest singular value
  std::vector<double> scatter, dof;  ///< of each group; 0 where there is none
  std::vector<RigidCurve> curves;    ///< that the readings determine
  std::vector<std::string> withheld;  ///< curves and squarenesses that they do not
  std::vector<std::pair<std::string, RigidValue>>
      squareness;  ///< C0Y, B0Z, A0Z, as far as identifiable
  VolumeMap map;
};

/// Names of the 21 errors.
const std::vector<std::string>& rigid_errors();

/// An error if there are fewer readings than unknowns of the set-up, or a name that is none. Lines
/// of the model, if there is one: those given, in their order; it then has the inputs of what is
/// stated, and u of the results is that of the repetition alone.
Expected<RigidSolution> solve_rigid_body(const std::vector<RigidLine>&, const RigidWish&,
                                         const ReadingModel* = nullptr);

/// e(p) of a size of 1 m (1 rad) of a polynomial term of an error: the columns of the above.
Corner rigid_term(const std::string& error, std::size_t degree, const Corner& at, const Corner& low,
                  const Corner& high);

}  // namespace nonio::math
