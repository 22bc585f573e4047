// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "laboratory/assessment/series.h"
#include "laboratory/statistics/table_change.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Returns the standard uncertainty of the usual change of scale between campaigns, um/mm or
/// arcsec/deg.
double usual_scale_change(bool rotary);
/// Returns the name in ids of findings, such as "wrong-sign" or "in-addition".
const char* loading_name(statistics::Loading loading);
/// Smallest standard uncertainty of a difference between two campaigns, um or arcsec.
inline constexpr double change_resolution = 0.1;

/// Returns the changes between successive campaigns of an axis that were caused by loading or
/// removing a table, from `control_tables` in results.json. The last eight known tables are tried:
/// those written by or active in earlier campaigns and those in the machine record.
std::vector<reports::TableLoaded> tables_loaded(const AssessedMachine& machine);
/// Two successive campaigns of an axis that state different active backlash values.
struct BacklashChange {
  reports::TableLoaded between;  ///< axis, dates and campaigns
  double change = 0.0;           ///< m or rad
};
std::vector<BacklashChange> backlash_changes(const AssessedMachine& machine);
/// Returns the pairs of successive campaigns of an axis of which one does not state the active
/// table.
std::vector<reports::TableLoaded> tables_unstated(const AssessedMachine& machine);

}  // namespace nonio::assessment
