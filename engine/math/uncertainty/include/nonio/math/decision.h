// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "nonio/sdk/results.h"

namespace nonio::math {

/// With an upper limit: ISO 14253-1:2017, default rule: a probability of 95 % at least, guard band
/// 1.65 u = 0.825 U (k = 2) to both sides; "iso14253-1:2013", guard band U to both sides;
/// ILAC-G8:09/2019, simple acceptance (4.2.1) and guard band w = U (4.2.2). An empty rule is the
/// default one. Confidence of the reading: medium.
Decision decide(double value, double U, double tolerance, std::string_view rule = "iso14253-1");

}  // namespace nonio::math
