// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace nonio::math {

/// xm = sum x_i/n, plus the mean of x_i - xm: two passes, so that a large common offset costs no
/// digits. In the unit of x. NaN for an empty list.
double mean(std::span<const double> x);
/// sqrt(sum (x_i - xm)^2/(n - 1)), in the unit of x; NaN for fewer than two values.
double standard_deviation(std::span<const double> x);
/// Middle value, of an even number the mean of the two in the middle; NaN for an empty list.
double median(std::span<const double> x);
/// 1.4826 (= 1/Phi^-1(3/4)) times the median absolute deviation.
double robust_deviation(std::span<const double> x);

}  // namespace nonio::math
