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

/// Sets the text `name` of the line's finding.
void put_text(reports::WorkItem& line, const char* name, std::string text);

/// Returns the lines of one machine: out of tolerance, changed, soon out, overdue, indeterminate,
/// changed with its instrument, and fixed in this run. Acknowledgements are not applied yet. A
/// change that explains another line is part of that line.
std::vector<reports::WorkItem> lines_of_machine(const AssessedMachine& machine,
                                                const reports::MachineHistory& described,
                                                const LastRun& last_run);

}  // namespace nonio::assessment
