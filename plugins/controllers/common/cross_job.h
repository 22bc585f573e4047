// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/compensation.h"
#include "nonio/sdk/plugin.h"

/// Tables that correct one axis from the position of another: straightness and squareness from the
/// diagonals, on the points of their pitch.
namespace nonio::controllers {

/// Error of axis `output` over axis `input`, 0 at the first point. SI.
struct CrossCurve {
  std::string input, output;
  std::vector<double> position, value;
};

/// EYX over X, and EXY with squareness over Y, of one set of diagonals.
struct CrossJob {
  std::string measurement;  ///< the first one of the set
  CrossCurve along_x, along_y;
  std::vector<double> D1, D2;  ///< the diagonals as read
};

/// Of the analyses that could separate both straightnesses: what is not known has no table.
std::vector<CrossJob> cross_jobs(const Results&);

/// Ranges of both diagonals before, and after with what the control adds; a table that makes one
/// of them worse gives a finding.
void predict_diagonals(const CrossJob&, const math::Correction& of_y, const math::Correction& of_x,
                       OutputResult& result);

}  // namespace nonio::controllers
