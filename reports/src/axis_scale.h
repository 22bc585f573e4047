// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nonio::reports {

/// A scale with round ticks.
struct AxisScale {
  double from = 0, to = 1;
  std::vector<double> ticks;
  std::vector<std::string> labels;

  double at(double value) const { return (value - from) / (to - from); }  ///< 0 to 1
};

/// From `low` to `high` with about `count` ticks at 1, 2, 2.5 or 5 times a power of ten, or at
/// parts of a turn, or at whole numbers.
enum class Ticks { decimal, turn, whole };
AxisScale axis_scale(double low, double high, int count, Ticks ticks, std::string_view language);

}  // namespace nonio::reports
