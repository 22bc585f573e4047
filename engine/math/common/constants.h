// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <numbers>

namespace nonio::math {

inline constexpr double full_turn = 2.0 * std::numbers::pi;  // rad
// docs/dev/constants.md, A1.
inline constexpr double significance = 0.01;  // of the tests behind findings
inline constexpr double rounding = 1e-10;     // m or rad: less than the scatter of any machine
/// Standard uncertainty of a quantity within a full range of 1, and of a limit of 1 that is reached
/// from one side.
inline constexpr double of_full_range = std::numbers::inv_sqrt3 / 2.0,
                        of_limit = std::numbers::inv_sqrt3;
inline constexpr double largest_coordinate = 1e6;  // m; beyond it a micrometre has no digits
inline constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

}  // namespace nonio::math
