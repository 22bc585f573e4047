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
/// Chain bed - X - Y - Z - tool, no tool offset, small errors (ISO 230-1 names); y, z from the
/// middle of the volume:
///
///     e_x = EXX + EXY + EXZ - y ECX + z (EBX + EBY + B0Z) - y C0Y
///     e_y = EYX + EYY + EYZ - z (EAX + EAY + A0Z)
///     e_z = EZX + EZY + EZZ + y EAX
///
/// t = -1..1 over the travel, P_k Legendre polynomials:
///
///     positioning   sum of P_k(t), k = 1..degree   (a constant is the zero of the readings)
///     straightness  sum of P_k(t), k = 2..degree   (a slope is squareness, or of the set-up)
///     angle         sum of P_k(t), k = 1..degree   (a constant is squareness)
///
/// A reading senses n . e; a reading of an angle is the angle itself. The readings of a line share
/// an unknown zero, and half the reversal if the line was read from both sides. Further unknowns:
/// the slope of a line across its travel; for a step diagonal, two tilts of its mirror, and (w x
/// n).(P - Q) theta for each angle theta about w, because the mirror turns with the tool (P: vector
/// from the first reading, Q: vector to the farthest). Lines may share unknowns: the positions of
/// an artefact and of its balls (rigid_artefact.h), the set-up and the error of a square. Stated
/// values of such unknowns have the weight of their standard uncertainty.
///
/// Singular values below `rank_below` of the largest are treated as 0. A result is given if no
/// combination of errors that changes no reading changes it. The scatter of a group of readings is
/// estimated with the fit, s^2 = r'r / sum(1 - h) with the leverages h, iterated until it is stable
/// (Helmert; Foerstner's simplification). Derived (docs/dev/estimators.md).
namespace nonio::math {

struct RigidReading {
  Corner at{};         ///< position of the axes, m
  Corner sense{};      ///< direction of sensing, unit vector; all 0 for an angle
  int way = 0;         ///< direction of motion along its line, +1 or -1
  double value = 0.0;  ///< reading, m or rad
  double u = 0.0;      ///< for a stated value: its standard uncertainty
};

struct RigidLine {
  enum class Kind {
    along,
    across,
    mirror,
    angle,
    point,  ///< a probed coordinate: the line has no zero of its own
    stated  ///< stated values of shared unknowns; not errors of the machine
  };
  Kind kind = Kind::along;
  std::size_t of = 0, about = 0;  ///< for an angle: axis that moves, axis about which it turns
  std::size_t group = 0;          ///< scatter group; not used for stated values
  std::vector<RigidReading> readings;
  /// An unknown of the set-up that several lines share, by its index from 0.
  struct Shared {
    std::size_t unknown = 0;
    std::vector<double> of_reading;
  };
  std::vector<Shared> shared{};
  bool own_slope = true;  ///< for a line across its travel: whether its slope is an unknown
};

/// Polynomial degrees that are tried if none is requested.
inline constexpr std::size_t least_degree = 2, most_degree = 8;
inline constexpr double rank_below = 1e-6;

struct RigidWish {
  Corner low{}, high{};             ///< corners of the volume, m
  std::vector<std::string> errors;  ///< ISO 230-1 names; empty: all errors of axes that move
  std::size_t degree = 0;  ///< degree of the polynomials; 0: by Schwarz's criterion, 2 to 8
  std::size_t parts = 4;   ///< intervals of the map per axis
};

struct RigidValue {
  double value = 0.0, u = 0.0;
  Shares shares;
};

struct RigidCurve {
  std::string name;
  std::size_t axis = 0;
  /// positions, values and their u, m; values and u of angles in rad
  std::vector<double> position, value, u;
  std::vector<Shares> shares;
};

/// Errors that together change no reading: coefficients of their terms, the first one 1. "EYX.3":
/// the part of EYX with P_3.
using Combination = std::vector<std::pair<std::string, double>>;

struct RigidSolution {
  /// `rank`: number of identifiable combinations of unknowns; `readings`: without stated values.
  std::size_t degree = 0, unknowns = 0, rank = 0, readings = 0;
  std::vector<double> singular;     ///< of all unknowns, relative to the largest, descending
  std::vector<std::string> unseen;  ///< errors that affect no reading
  std::vector<Combination> combinations;
  Combination weakest;  ///< identifiable combination with the smallest singular value
  /// standard deviation of each group and its degrees of freedom; 0 if not estimated
  std::vector<double> scatter, dof;
  std::vector<RigidCurve> curves;
  std::vector<std::string> withheld;  ///< curves and squarenesses that are not determined
  std::vector<std::pair<std::string, RigidValue>> squareness;  ///< C0Y, B0Z, A0Z, if identifiable
  VolumeMap map;
};

/// ISO 230-1 names of the 21 errors.
const std::vector<std::string>& rigid_errors();

/// Errors: not more readings than unknowns of the set-up and identifiable combinations, or an
/// unknown name. The lines of the model must be those given, in their order; it also contains the
/// inputs of stated values, and u of the results is that of the repetition alone.
Expected<RigidSolution> solve_rigid_body(const std::vector<RigidLine>&, const RigidWish&,
                                         const ReadingModel* = nullptr);

/// Returns e(p) for a coefficient of 1 m (1 rad) of a polynomial term that is not scaled.
Corner rigid_term(const std::string& error, std::size_t degree, const Corner& at, const Corner& low,
                  const Corner& high);

}  // namespace nonio::math
