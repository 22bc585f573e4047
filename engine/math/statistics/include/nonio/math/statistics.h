// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace nonio::math {

/// Returns the arithmetic mean, in the unit of x; NaN for an empty list. It is computed in two
/// steps, so that a large common offset causes no loss of precision.
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
