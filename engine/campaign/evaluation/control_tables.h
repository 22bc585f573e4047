// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluation.h"
#include "nonio/sdk/json_writer.h"

namespace nonio::evaluation {

/// What the tables of an axis by its own position add together, at all of their points.
AxisCorrection correction_of(const std::vector<LoadedTable>& tables, const std::string& axis);

/// Member `control_tables` of results.json: by it the history recognizes a table that was loaded
/// between two campaigns.
std::vector<ControlTables> control_tables(const reading::ReadCampaign& read, const Results& results,
                                          const std::vector<WantedController>& controllers);
void put_control_tables(JsonWriter& json, const std::vector<ControlTables>& all);

}  // namespace nonio::evaluation
