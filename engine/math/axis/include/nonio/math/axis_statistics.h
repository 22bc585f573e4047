// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "nonio/math/axis_test.h"

/// Statistics of the readings at each target, from which every rule of positioning is computed.
///
///     xm_i+-  = sum_j x_ij/n                              m or rad, one direction
///     xm_i    = (xm_i+ + xm_i-)/2;  B_i = xm_i+ - xm_i-
///     s_i+-   = sqrt(sum_j (x_ij - xm_i)^2/(n - 1))
///     low, high: smallest and largest x_ij;  first: x_ij of the earliest run
///
/// Source: ISO 230-2:2014 clause 2 (symbols). Range: any test. No errors: a value that the readings
/// do not determine is NaN (s with one reading; all values of a direction from which a target was
/// not approached).
namespace nonio::math {

struct AxisStatistics {
  struct Side {
    std::size_t n = 0;
    double mean, s;
    double low, high;
    double first;           ///< deviation in the earliest run
    std::uint32_t run = 0;  ///< number of the earliest run
  };
  struct Target {
    double target;
    Side plus, minus;
    double mean;  ///< mean of both directions, xm_i
    double B;     ///< reversal, B_i = xm_i+ - xm_i-
  };
  std::vector<Target> targets;  ///< sorted by position, ascending
};

AxisStatistics axis_statistics(const AxisTest&);

/// Range, largest and smallest of the values passed to `put`; NaN without values, or if one of them
/// is NaN.
class Extent {
 public:
  void put(double value);
  double range() const;
  double largest() const;
  double smallest() const;

 private:
  bool given() const { return known_ && high_ >= low_; }
  bool known_ = true;
  double low_ = INFINITY, high_ = -INFINITY;
};

/// Slopes of the means over the targets, m/m or rad/rad: of the least-squares line, and from the
/// first target to the last. The means are those of both directions, or of the only direction that
/// was measured at every target. NaN if there is no such direction, or with fewer than two targets.
struct Slopes {
  double least_squares, end_points;
};
Slopes slopes_of(const AxisStatistics&);

}  // namespace nonio::math
