// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// A line that a person has acknowledged, until then, is known. It is new again when what it says
/// happened after that day, or when its value has moved by more than U since: from the value that
/// the acknowledgement names, else from the last one before its day. What else the line lists is
/// known if it was open on that day too and has not moved; a new line is returned with the rest.
std::optional<reports::MorningLine> acknowledge(reports::MorningLine& line,
                                                const AssessedMachine& machine,
                                                const store::StoredLogs& logs,
                                                const std::string& date);

}  // namespace nonio::assessment
