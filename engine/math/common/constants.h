// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <numbers>

namespace nonio::math {

inline constexpr double full_turn = 2.0 * std::numbers::pi;  // rad
// Level of the tests of findings: docs/dev/constants.md, A1.
inline constexpr double significance = 0.01;
inline constexpr double rounding = 1e-10;  // m or rad; smaller than the scatter of any machine
/// Standard uncertainty of a rectangular distribution over a full range of 1, and over +-1.
inline constexpr double of_full_range = std::numbers::inv_sqrt3 / 2.0,
                        of_limit = std::numbers::inv_sqrt3;
// largest accepted coordinate, m; adjacent doubles of this size differ by about 0.1 nm
inline constexpr double largest_coordinate = 1e6;
inline constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

constexpr double squared(double x) { return x * x; }

}  // namespace nonio::math
