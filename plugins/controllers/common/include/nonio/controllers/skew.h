// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "nonio/controllers/kit.h"

/// Squareness of planes by two diagonals and a side, as required by firmware of 3D printers.
namespace nonio::controllers {

/// AC is the diagonal from the corner where both axes begin, BD the other diagonal, AD the side
/// along the first axis.
struct Face {
  std::string plane;  ///< XY
  double AC, BD, AD;  ///< m
  std::string first, second;
};

/// Returns the planes whose squareness the analyses determine, over the measured travels.
std::vector<Face> faces_of(const ControllerInput&, OutputResult&);

/// Whether the campaign contains diagonals or step diagonals.
bool has_squareness(const Campaign&);

/// Tangent of the inclination of the second axis towards the first one, as Klipper's
/// calc_skew_factor and Marlin compute it: side = sqrt(2 AC^2 + 2 BD^2 - 4 AD^2) / 2, tan(pi/2 -
/// acos((AC^2 - side^2 - AD^2) / (2 side AD))).
double skew_factor(double AC, double BD, double AD);

/// Adds `per_length` times the position of `input` to `output`, at any position.
LoadedTable linear_table(std::string output, std::string input, double per_length);

/// Tables of the correction that the firmware adds: -y xy - z (xz - xy yz) to X, and -z yz to Y,
/// where xy, xz and yz are the factors.
std::vector<LoadedTable> skew_tables(const std::map<std::string, double>& factors);

/// Predictions are computed from the tables that the parser of `Writer` returns.
Expected<OutputResult> write_skew(const ControllerInput&, const Writer&,
                                  std::string (*text)(const std::vector<Face>&));
ControlTable skew_declared(std::string name);

}  // namespace nonio::controllers
