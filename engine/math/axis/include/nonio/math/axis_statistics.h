// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "nonio/math/axis_test.h"

/// What every rule of positioning is made from.
///
///     xm_i+-  = sum_j x_ij/n                           m or rad, one direction
///     xm_i    = (xm_i+ + xm_i-)/2;  B_i = xm_i+ - xm_i-
///     s_i+-   = sqrt(sum_j (x_ij - xm_i)^2/(n - 1))
///     low, high: smallest and largest x_ij; first: of the earliest run
///
/// Source: ISO 230-2:2014 clause 2 (symbols). Range: any test; no errors: what the readings do not
/// give is NaN (s with one reading, all of a direction that a target was not reached from).
namespace nonio::math {

struct AxisStatistics {
  struct Side {
    std::size_t n = 0;
    double mean, s;
    double low, high;
    double first;           ///< x of the earliest run
    std::uint32_t run = 0;  ///< which that is
  };
  struct Target {
    double target;
    Side plus, minus;
    double mean;  ///< xm_i
    double B;     ///< B_i
  };
  std::vector<Target> targets;  ///< ascending
};

AxisStatistics axis_statistics(const AxisTest&);

/// Largest and smallest of what was put in; one NaN makes the whole NaN.
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

/// Slopes of the bidirectional means (of the means of the one direction that there is) over the
/// targets, m/m or rad/rad: of the least-squares line, and from the first target to the last. NaN
/// with fewer than two targets.
struct Slopes {
  double least_squares, end_points;
};
Slopes slopes_of(const AxisStatistics&);

}  // namespace nonio::math
