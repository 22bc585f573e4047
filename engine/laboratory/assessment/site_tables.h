// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Returns one entry for each month in which the machine was measured or an event happened.
std::vector<reports::MonthOfMachine> months_of(const AssessedMachine& machine,
                                               const reports::MachineHistory& described);

/// Returns the campaigns of one machine, with one entry for each instrument, certificate and end of
/// validity. Campaigns that state no instrument are left out.
std::vector<reports::InstrumentUse> instruments_of(const AssessedMachine& machine,
                                                   const std::filesystem::path& out);
/// Joins the lists of all machines: the campaigns with one instrument and certificate become one
/// entry, in which they are sorted by day and campaign.
std::vector<reports::InstrumentUse> joined(
    const std::vector<const std::vector<reports::InstrumentUse>*>& of_machines);

/// Last value of a quantity among those with another state than as-left, for the comparison with
/// other machines of the same model.
struct ComparedValue {
  std::string axis, quantity;
  Quantity unit = Quantity::deviation;
  double value = 0.0, u = 0.0;
  /// conditions that must be equal for a comparison, as JSON without the travel and the state of
  /// the compensation
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
/// Compares models with at least three machines, by quantity and for travels that differ by at most
/// 10 %: distance from the median in robust standard deviations (1.4826 times the median of the
/// distances). Of more than 60 machines, the 60 farthest from the median are returned.
std::vector<reports::ModelComparison> comparisons_of(const std::vector<ComparedMachine>& machines);

}  // namespace nonio::assessment
