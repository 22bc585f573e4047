// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nonio::reports {

struct AxisScale {
  double from = 0, to = 1;
  std::vector<double> ticks;
  std::vector<std::string> labels;

  double at(double value) const {
    return (value - from) / (to - from);
    /// 0 at `from`, 1 at `to`.
  }
};

/// Covers `low` to `high` with about `count` ticks at multiples of 1, 2, 2.5 or 5 times a power of
/// ten, at fractions of a revolution, or at whole numbers.
enum class Ticks { decimal, turn, whole };
AxisScale axis_scale(double low, double high, int count, Ticks ticks, std::string_view language);

}  // namespace nonio::reports
