// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace nonio::math {

/// Returns xm = sum x_i/n plus the mean of x_i - xm: in two steps, so that a large common offset
/// does not cost digits. In the unit of x. NaN for an empty list.
double mean(std::span<const double> x);
/// Returns sqrt(sum (x_i - xm)^2/(n - 1)), in the unit of x; NaN for fewer than two values.
double standard_deviation(std::span<const double> x);
/// Returns the middle value, or the mean of the two middle values; NaN for an empty list or if a
/// value is NaN.
double median(std::span<const double> x);
/// Returns 1.4826 (= 1/Phi^-1(3/4)) times the median absolute deviation: a robust standard
/// deviation. NaN if `median` is.
double robust_deviation(std::span<const double> x);

}  // namespace nonio::math
