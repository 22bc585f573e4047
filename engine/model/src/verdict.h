// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.h"

namespace nonio::model {

inline constexpr double most_suspects = 0.06;  // of the readings; beyond, they do not repeat

/// Verdict, where the model fails, and the plans for the verdict's aliases; the verdict's effect
/// comes to lead `out.candidates`.
void judge(const Finding& finding, Explanation& out);

}  // namespace nonio::model
