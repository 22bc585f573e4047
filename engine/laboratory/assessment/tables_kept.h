// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Largest number of days between the readings that a table was made from and the readings as left.
inline constexpr int longest_until_left = 31;

/// Checks for each axis whether its last table achieved the E, B and M that results.json had
/// predicted, by comparing the last as-left measurement with the last prediction in its campaign or
/// before. A prediction refers to means, so 2 s of the readings as left is added to its uncertainty
/// for the scatter of runs (the range of 80 means of two runs each is 3.5 s). A table is not good
/// if one of these results is worse than predicted with p < 1 % (Bonferroni). Axes are left out if
/// several lines were measured, if the repeatability is unknown, or if more than
/// `longest_until_left` days are between the two measurements.
std::vector<reports::TableKept> tables_kept(const AssessedMachine& machine);

}  // namespace nonio::assessment
