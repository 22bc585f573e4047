// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "laboratory/assessment/last_run.h"
#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// A line with an id that is the same in every run: the finding and its subject.
reports::WorkItem line_of(reports::WorkItem::Kind kind, const char* finding, const std::string& of);

/// The text with that name in its words.
void put_text(reports::WorkItem& line, const char* name, std::string text);

/// Lines of one machine: out of tolerance, changed, soon out, overdue, indeterminate, changed with
/// its instrument, and fixed in this run; acknowledgements are not applied yet. What a change
/// explains is part of its line.
std::vector<reports::WorkItem> lines_of_machine(const AssessedMachine& machine,
                                                const reports::MachineHistory& described,
                                                const LastRun& last_run);

}  // namespace nonio::assessment
