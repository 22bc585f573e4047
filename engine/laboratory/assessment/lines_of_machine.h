// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "laboratory/assessment/last_run.h"
#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Returns a worklist line whose id consists of the finding and the subject `of`, so that it is the
/// same in every run.
reports::WorkItem line_of(reports::WorkItem::Kind kind, const char* finding, const std::string& of);

/// Adds a text with this name to the line's finding.
void put_text(reports::WorkItem& line, const char* name, std::string text);

/// Returns the lines of one machine: values that are out of tolerance, indeterminate or fixed in
/// this run, limits without a value, changes, also with another instrument, tables that were loaded
/// wrongly or without a statement or achieved less than predicted, withheld outputs, forecasts of
/// values soon out of tolerance, an overdue calibration, and campaigns dated after the run.
/// Acknowledgements are not applied yet. A change that explains another line is part of that line.
std::vector<reports::WorkItem> lines_of_machine(const AssessedMachine& machine,
                                                const reports::MachineHistory& described,
                                                const LastRun& last_run);

}  // namespace nonio::assessment
