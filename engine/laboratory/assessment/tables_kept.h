// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Days between the readings that a table was made from and those that were left.
inline constexpr int longest_until_left = 31;

/// Of each axis, whether its last table did what results.json had predicted (E, B and M): the last
/// as-left measurement against the last prediction before it. The promise holds for means: what the
/// runs scatter around them is allowed for by 2 s of the readings as left (the range of 80 means
/// of two runs each comes to 3.5 s). Not good: worse than promised with p < 1 % over the three.
/// Nothing of an axis where several lines were measured, or no repeatability is known.
std::vector<reports::TableKept> tables_kept(const AssessedMachine& machine);

}  // namespace nonio::assessment
