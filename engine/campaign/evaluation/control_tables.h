// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/evaluation/evaluation.h"
#include "nonio/sdk/json_writer.h"

namespace nonio::evaluation {

/// Returns the sum of all tables that correct an axis by its own position, at all of their points.
AxisCorrection correction_of(const std::vector<LoadedTable>& tables, const std::string& axis);

/// Returns an entry for each measurement of an axis with 3 to 500 targets, by which the history
/// recognizes a table that was loaded between two campaigns. Empty unless `controllers` contains
/// the machine's control.
/// A note states each measurement with more targets.
std::vector<ControlTables> control_tables(const reading::ReadCampaign& read, const Results& results,
                                          const std::vector<WantedController>& controllers,
                                          std::vector<Remark>& notes);
void put_control_tables(JsonWriter& json, const std::vector<ControlTables>& all);

}  // namespace nonio::evaluation
