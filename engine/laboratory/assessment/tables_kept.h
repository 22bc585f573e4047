// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Largest number of days between the readings that a table was computed from and those as left.
inline constexpr int longest_until_left = 31;

/// Checks by axis whether the last table achieved the E, B and M that results.json predicted.
/// Because a prediction refers to means, 2 s of the readings as left is added to its uncertainty
/// for the scatter of runs (the range of 80 means of two runs is 3.5 s). A table is not good if a
/// result is worse than predicted with p < 1 % (Bonferroni). Axes with several measured lines or
/// without a known repeatability are omitted.
std::vector<reports::TableKept> tables_kept(const AssessedMachine& machine);

}  // namespace nonio::assessment
