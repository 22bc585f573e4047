// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "laboratory/assessment/series.h"
#include "laboratory/assessment/tonight.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// A line with an id that is the same in every run: the finding and its subject.
reports::MorningLine line_of(reports::MorningLine::Kind kind, const char* finding,
                             const std::string& of);

/// What its words say under that name.
void put_text(reports::MorningLine& line, const char* name, std::string text);

/// Out of tolerance, changed, soon out, overdue, undecided, moved with its instrument, and fixed
/// tonight; nothing acknowledged yet. What a change explains is told with it.
std::vector<reports::MorningLine> lines_of_machine(const AssessedMachine& machine,
                                                   const reports::MachineHistory& described,
                                                   const Tonight& tonight);

}  // namespace nonio::assessment
