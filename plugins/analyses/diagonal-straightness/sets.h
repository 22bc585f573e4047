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
  std::string name;                ///< the state: "final", or empty
  std::vector<std::size_t> lines;  ///< measurements of kind diagonal, in the manifest's order
};

std::vector<Set> sets_of(const Campaign&);
/// The set whose first line this measurement is; none for the others.
const Set* set_led_by(const std::vector<Set>&, const Campaign&, const Measurement&);

/// Everything that the kernel needs, and the names for the results.
struct Collected {
  math::DiagonalReadings readings;
  std::string x_axis, y_axis;
  /// Y carries X: the kernel's X is the machine's Y, which mirrors the plane, until `turn_back`.
  bool mirrored = false;
  double sides_apart = 0.0;       ///< distance of the two lines of X, m; 0: there is one
  double x0 = 0.0, y0 = 0.0;      ///< origin of the grid, m
  std::vector<std::string> uses;  ///< ids
  std::string lines_of_x;         ///< ids of the positioning of X, in words
  bool one_direction = false;     ///< a diagonal was not read from both at every stop
  double reversal_of_diagonals = 0.0, reversal_of_axes = 0.0, u_reversal = 0.0;
  std::vector<Finding> findings;  ///< what does not hinder
  std::size_t D1 = 0, D2 = 0;     ///< measurements
};

template <class T>
using OrRefusal = tl::expected<T, Finding>;

/// Readings and results of a mirrored plane by the names and signs of the machine's own axes.
void turn_back(Collected&, math::DiagonalResult&);

OrRefusal<Collected> collect(const AnalysisInput&, const std::vector<Set>&, const Set&);

}  // namespace nonio::diagonal_straightness
