// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "laboratory/assessment/series.h"
#include "laboratory/statistics/table_change.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Machines change their scale between campaigns by this much without any cause that is worth a
/// name: standard uncertainty, um/mm or arcsec/deg.
double usual_scale_change(bool rotary);
/// As in the ids of findings: wrong-sign, in-addition.
const char* loading_name(statistics::Loading loading);
/// What two campaigns of an instrument repeat, um or arcsec.
inline constexpr double change_resolution = 0.1;

/// The changes between two campaigns of an axis that are tables: of each pair of neighbours whose
/// results.json has `control_tables`. Known tables are those that the campaigns before the later one
/// wrote, and those of the record of the machine.
std::vector<reports::TableLoaded> tables_loaded(const AssessedMachine& machine);
/// The pairs of which a campaign does not state what was active, though there is a table.
std::vector<reports::TableLoaded> tables_unstated(const AssessedMachine& machine);

}  // namespace nonio::assessment
