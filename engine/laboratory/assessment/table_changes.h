// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// The changes between two campaigns of an axis that are tables: of each pair of neighbours whose
/// results.json has `control_tables`. Known tables are those that the campaigns before the later one
/// wrote, and those of the record of the machine.
std::vector<reports::TableLoaded> tables_loaded(const AssessedMachine& machine);
/// The pairs of which a campaign does not state what was active, though there is a table.
std::vector<reports::TableLoaded> tables_unstated(const AssessedMachine& machine);

}  // namespace nonio::assessment
