// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "nonio/controllers/kit.h"

/// Squareness as two diagonals and a side of each plane, as printers' firmware takes it.
namespace nonio::controllers {

/// One plane of two axes: AC from the corner where both begin, BD the other one, AD along the
/// first.
struct Face {
  std::string plane;          ///< XY
  double AC, BD, AD;          ///< m
  std::string first, second;  ///< the axes
};

/// The planes whose squareness the analyses know, over the travels they measured it on.
std::vector<Face> faces_of(const ControllerInput&, OutputResult&);

/// Something of which squareness may be known: diagonals, step diagonals.
bool has_squareness(const Campaign&);

/// tan of the lean of the second axis towards the first one; Klipper's calc_skew_factor, which is
/// Marlin's: side = sqrt(2 AC^2 + 2 BD^2 - 4 AD^2) / 2, tan(pi/2 - acos((AC^2 - side^2 - AD^2) /
/// (2 side AD))).
double skew_factor(double AC, double BD, double AD);

/// What is added to `output`: `per_length` times the position of `input`, wherever it is.
LoadedTable linear_table(std::string output, std::string input, double per_length);

/// x - y xy - z (xz - xy yz), y - z yz: what the firmware adds.
std::vector<LoadedTable> skew_tables(const std::map<std::string, double>& factors);

/// Files of the faces, predicted by `parse`.
Expected<OutputResult> write_skew(const ControllerInput&, const Writer&,
                                  std::string (*text)(const std::vector<Face>&));
/// What a firmware's skew correction is.
ControlTable skew_declared(std::string name);

}  // namespace nonio::controllers
