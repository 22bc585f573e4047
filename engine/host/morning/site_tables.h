// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/morning/series.h"
#include "nonio/reports/site.h"

namespace nonio::host::morning {

/// A cell for each month in which a machine was measured or something happened to it.
std::vector<reports::MonthOfMachine> months_of(const AssessedMachine& machine,
                                               const reports::MachineHistory& described);

/// What of one machine hangs on each instrument under each of its certificates.
std::vector<reports::InstrumentUse> instruments_of(const AssessedMachine& machine,
                                                   const std::filesystem::path& out);
/// Of all machines together.
std::vector<reports::InstrumentUse> joined(
    const std::vector<const std::vector<reports::InstrumentUse>*>& of_machines);

/// The point of a series by which its machine is compared with others; none if it is not.
const reports::HistoryPoint* compared_point(const reports::HistorySeries& series);

/// Models of three machines or more, quantity by quantity: distance from the median in robust
/// standard deviations (1.4826 times the median of the distances).
std::vector<reports::ModelComparison> comparisons_of(
    const std::vector<reports::MachineHistory>& described);

}  // namespace nonio::host::morning
