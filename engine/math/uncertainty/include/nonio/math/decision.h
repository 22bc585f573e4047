// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "nonio/sdk/results.h"

namespace nonio::math {

/// Decides conformity to an upper limit. The default, also for an empty `rule`, is ISO 14253-1:2017
/// with at least 95 %: guard band 1.65 u = 0.825 U (k = 2) on both sides. "iso14253-1:2013" has a
/// guard band U on both sides; ILAC-G8:09/2019 has simple acceptance (4.2.1) and a guard band U
/// (4.2.2). Indeterminate without a finite value and U.
Decision decide(double value, double U, double tolerance, std::string_view rule = "iso14253-1");

}  // namespace nonio::math
