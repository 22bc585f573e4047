// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace nonio::math {

/// NaN for an empty list. Two steps preserve precision if the values have a large common offset.
double mean(std::span<const double> x);
/// sqrt(sum (x_i - xm)^2/(n - 1)); NaN for fewer than two values.
double standard_deviation(std::span<const double> x);
/// NaN for an empty list, or if a value is NaN.
double median(std::span<const double> x);
/// 1.4826 (= 1/Phi^-1(3/4)) times the median absolute deviation; NaN if `median` is.
double robust_deviation(std::span<const double> x);

}  // namespace nonio::math
