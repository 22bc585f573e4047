// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "nonio/math/axis_test.h"

/// Statistics of the readings at each target, m or rad, in the symbols of ISO 230-2:2014 clause 2.
///
///     xm_i+-  = sum_j x_ij/n                              m or rad, one direction
///     xm_i    = (xm_i+ + xm_i-)/2;  B_i = xm_i+ - xm_i-
///     s_i+-   = sqrt(sum_j (x_ij - xm_i)^2/(n - 1))
///
/// NaN if the readings do not determine a value: s of a single reading, and mean, s, low, high and
/// first of a direction without readings.
namespace nonio::math {

struct AxisStatistics {
  struct Side {
    std::size_t n = 0;
    double mean, s;
    double low, high;
    double first;  ///< deviation in the earliest run
    std::uint32_t run = 0;
  };
  struct Target {
    double target;
    Side plus, minus;
    double mean;
    double B;
  };
  std::vector<Target> targets;  ///< sorted by position, ascending
};

AxisStatistics axis_statistics(const AxisTest&);

/// All results are NaN without values, or if one of the values is NaN.
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
