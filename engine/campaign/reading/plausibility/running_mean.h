// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::reading {

/// Mean from which values can be removed, for comparison of each pass with all others in linear
/// time.
struct RunningMean {
  double count = 0.0, mean = 0.0, squares = 0.0;

  void add(double value) {
    const double off = value - mean;
    count += 1.0;
    mean += off / count;
    squares += off * (value - mean);
  }

  RunningMean without(double value) const {
    constexpr double rounding = 1e-12;
    if (count < 1.5) return {};
    const double rest = mean - (value - mean) / (count - 1.0);
    const double left = squares - (value - mean) * (value - rest);
    return {count - 1.0, rest, left > rounding * squares ? left : 0.0};
  }
};

}  // namespace nonio::reading
