// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Returns one entry per month with a measurement, an event, or the beginning of one of `lines`.
std::vector<reports::MonthOfMachine> months_of(const AssessedMachine& machine,
                                               const reports::MachineHistory& described,
                                               const std::vector<reports::WorkItem>& lines);

/// Returns the campaigns by instrument, certificate and end of validity, without campaigns that
/// state no instrument.
std::vector<reports::InstrumentUse> instruments_of(const AssessedMachine& machine,
                                                   const std::filesystem::path& out);
/// Joins the lists of all machines. Campaigns with the same instrument and certificate are sorted
/// by date and campaign.
std::vector<reports::InstrumentUse> joined(
    const std::vector<const std::vector<reports::InstrumentUse>*>& of_machines);

/// Last value of a quantity before an adjustment, for the comparison with machines of the same
/// model.
struct ComparedValue {
  std::string axis, quantity;
  Quantity unit = Quantity::deviation;
  double value = 0.0, u = 0.0;
  /// Conditions of comparable values as JSON, without the travel and the state of the compensation.
  std::string conditions{};
  std::optional<double> travel{};  ///< distance from the first target to the last, m or rad
  bool rotary = false;
};
std::vector<ComparedValue> compared_of(const AssessedMachine& machine,
                                       const reports::MachineHistory& described);

struct ComparedMachine {
  const reports::MachineHistory* machine;
  const std::vector<ComparedValue>* values;
};
/// Compares at least three machines of one model by quantity, if their travels differ by at most 10
/// %: distance from the median in robust standard deviations (1.4826 times the median absolute
/// deviation). At most 60 machines are returned, those farthest from the median.
std::vector<reports::ModelComparison> comparisons_of(const std::vector<ComparedMachine>& machines);

}  // namespace nonio::assessment
