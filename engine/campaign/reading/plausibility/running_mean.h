// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace nonio::reading {

/// Mean of values and the sum of squares about it. A value can be removed again, so that a pass is
/// compared with all others in a time that does not depend on their number.
struct RunningMean {
  double count = 0.0, mean = 0.0, squares = 0.0;

  void add(double value) {
    const double off = value - mean;
    count += 1.0;
    mean += off / count;
    squares += off * (value - mean);
  }

  /// Returns the mean and squares without a value that was added.
  RunningMean without(double value) const {
    constexpr double rounding = 1e-12;
    if (count < 1.5) return {};
    const double rest = mean - (value - mean) / (count - 1.0);
    const double left = squares - (value - mean) * (value - rest);
    return {count - 1.0, rest, left > rounding * squares ? left : 0.0};
  }
};

}  // namespace nonio::reading
