// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "laboratory/assessment/series.h"
#include "laboratory/statistics/table_change.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Returns the standard uncertainty of the change of scale that normally occurs between campaigns
/// without a particular cause, in um/mm or arcsec/deg.
double usual_scale_change(bool rotary);
/// Returns the name used in ids of findings, for example wrong-sign or in-addition.
const char* loading_name(statistics::Loading loading);
/// Smallest standard uncertainty of a difference between two campaigns, um or arcsec.
inline constexpr double change_resolution = 0.1;

/// Returns the changes between two successive campaigns of an axis that were caused by loading or
/// removing a table, for campaigns whose results.json has `control_tables`. Known tables are those
/// that earlier campaigns wrote or had active, and those in the record of the machine; of more than
/// eight, the last eight.
std::vector<reports::TableLoaded> tables_loaded(const AssessedMachine& machine);
/// Returns the pairs of successive campaigns of an axis in which at least one campaign does not
/// state the active table.
std::vector<reports::TableLoaded> tables_unstated(const AssessedMachine& machine);

}  // namespace nonio::assessment
