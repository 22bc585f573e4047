// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/diagonals.h"
#include "nonio/math/measured_line.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

namespace nonio::diagonal_straightness {

/// Diagonals measured in one state of the machine.
struct Set {
  std::string name;                ///< such as "final"; empty if not stated
  std::vector<std::size_t> lines;  ///< indices of the diagonals, in manifest order
};

std::vector<Set> sets_of(const Campaign&);
/// The set whose first line is this measurement; null for any other measurement.
const Set* set_led_by(const std::vector<Set>&, const Campaign&, const Measurement&);

/// Input of the kernel, and names for its results.
struct Collected {
  math::DiagonalReadings readings;
  std::string x_axis, y_axis;
  /// Whether Y carries X: X of the kernel is then Y of the machine until `turn_back` is called.
  bool mirrored = false;
  double sides_apart = 0.0;       ///< distance of the two lines of X, m; 0 with one line
  double x0 = 0.0, y0 = 0.0;      ///< origin of the grid, m
  std::vector<std::string> uses;  ///< ids of the measurements used
  std::string lines_of_x;         ///< ids of the positioning lines of X, as text
  bool one_direction = false;     ///< whether a diagonal has targets read from one direction only
  double reversal_of_diagonals = 0.0, reversal_of_axes = 0.0, u_reversal = 0.0;
  std::vector<Finding> findings;  ///< remarks that do not prevent the evaluation
  std::size_t D1 = 0, D2 = 0;     ///< indices of both diagonals in the measurements
};

template <class T>
using OrRefusal = tl::expected<T, Finding>;

/// Converts readings and results of a mirrored plane to the axis names and signs of the machine.
void turn_back(Collected&, math::DiagonalResult&);

OrRefusal<Collected> collect(const AnalysisInput&, const std::vector<Set>&, const Set&);

}  // namespace nonio::diagonal_straightness
