// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluation.h"
#include "nonio/sdk/json_writer.h"

namespace nonio::evaluation {

/// Returns the sum of all tables that correct an axis by its own position, at the points of all of
/// these tables.
AxisCorrection correction_of(const std::vector<LoadedTable>& tables, const std::string& axis);

/// Returns the member `control_tables` of results.json: an entry for each measurement of an axis
/// with 3 to 500 targets, if `controllers` contains the controller of the machine's control. The
/// history uses it to recognize a table that was loaded between two campaigns.
std::vector<ControlTables> control_tables(const reading::ReadCampaign& read, const Results& results,
                                          const std::vector<WantedController>& controllers);
void put_control_tables(JsonWriter& json, const std::vector<ControlTables>& all);

}  // namespace nonio::evaluation
