// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "laboratory/assessment/last_run.h"
#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Returns a line with the id "finding:of", which is the same in every run.
reports::WorkItem line_of(reports::WorkItem::Kind kind, const char* finding, const std::string& of);

void put_text(reports::WorkItem& line, const char* name, std::string text);

/// Returns the worklist of one machine, before acknowledgements are applied: values out of
/// tolerance, indeterminate, or conforming again, limits without a value, changes, compensation
/// tables, withheld outputs, forecasts, an overdue calibration and campaigns dated after the run. A
/// change that explains another line is part of it.
std::vector<reports::WorkItem> lines_of_machine(const AssessedMachine& machine,
                                                const reports::MachineHistory& described,
                                                const LastRun& last_run);

}  // namespace nonio::assessment
