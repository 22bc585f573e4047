// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/sdk/error.h"

/// What all controllers' tables have in common: the curve to be compensated, the grid, integers
/// without drift, and what is left when the control has applied the table.
namespace nonio::math {

/// The deviation that a table should take away; m or rad over m or rad.
struct ErrorCurve {
  std::vector<double> position;     ///< strictly ascending
  std::vector<double> mean;         ///< of both directions
  std::vector<double> plus, minus;  ///< empty if that direction was not measured at every position

  /// Linear between the points, the end value outside.
  static double at(const std::vector<double>& position, const std::vector<double>& value, double x);
};

ErrorCurve error_curve(const AxisTest& test);

struct Grid {
  double first = 0.0, step = 0.0;  ///< m or rad
  std::size_t points = 0;
  double position(std::size_t i) const { return first + step * static_cast<double>(i); }
  double last() const { return points == 0 ? first : position(points - 1); }
};

}  // namespace nonio::math
