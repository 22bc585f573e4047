// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "curves.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

namespace nonio::diagonals {

/// Diagonals measured together: `D1 00` and `D2 00` are the set "00", `D1` and `D2` the set "".
struct Set {
  std::string name;
  std::vector<std::size_t> lines;  ///< measurements of kind diagonal, in the manifest's order
};

/// What an id has behind its first blank: "final" of "D1 final".
std::string ending(const std::string& id);
std::vector<Set> sets_of(const Campaign&);
/// The set whose first line this measurement is; none for the others.
const Set* set_led_by(const std::vector<Set>&, const Campaign&, const Measurement&);

/// Everything that the kernel needs, and what the results are told with.
struct Collected {
  math::DiagonalReadings readings;
  std::string x_axis, y_axis;
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

OrRefusal<Collected> collect(const AnalysisInput&, const std::vector<Set>&, const Set&);

}  // namespace nonio::diagonals
