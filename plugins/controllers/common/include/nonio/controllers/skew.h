// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "nonio/controllers/kit.h"

/// Squareness of planes by two diagonals and a side, as required by firmware of 3D printers.
namespace nonio::controllers {

/// A plane of two axes: diagonal AC from the corner where both axes begin, BD the other diagonal,
/// AD the side along the first axis.
struct Face {
  std::string plane;          ///< name of the plane: XY
  double AC, BD, AD;          ///< m
  std::string first, second;  ///< the axes
};

/// Returns the planes whose squareness the analyses determine, over the measured travels.
std::vector<Face> faces_of(const ControllerInput&, OutputResult&);

/// Whether the campaign contains measurements of squareness: diagonals, step diagonals.
bool has_squareness(const Campaign&);

/// Returns tan of the inclination of the second axis towards the first one; Klipper's
/// calc_skew_factor, which equals Marlin's: side = sqrt(2 AC^2 + 2 BD^2 - 4 AD^2) / 2, tan(pi/2 -
/// acos((AC^2 - side^2 - AD^2) / (2 side AD))).
double skew_factor(double AC, double BD, double AD);

/// Returns a table that adds `per_length` times the position of `input` to `output`, at any
/// position.
LoadedTable linear_table(std::string output, std::string input, double per_length);

/// Returns what the firmware adds, as tables: x - y xy - z (xz - xy yz), y - z yz.
std::vector<LoadedTable> skew_tables(const std::map<std::string, double>& factors);

/// Writes the files of the planes; predictions use the tables that `parse` returns.
Expected<OutputResult> write_skew(const ControllerInput&, const Writer&,
                                  std::string (*text)(const std::vector<Face>&));
/// Returns the declaration of a firmware's skew correction.
ControlTable skew_declared(std::string name);

}  // namespace nonio::controllers
