// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace nonio::math {

/// Two passes, so that a large common offset costs no digits. NaN for an empty list.
double mean(std::span<const double> x);
/// Estimator with n - 1; NaN for fewer than two values.
double standard_deviation(std::span<const double> x);
double median(std::span<const double> x);
/// 1.4826 (= 1/Phi^-1(3/4)) times the median absolute deviation.
double robust_deviation(std::span<const double> x);

}  // namespace nonio::math
