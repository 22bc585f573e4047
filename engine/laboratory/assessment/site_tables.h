// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// A cell for each month in which a machine was measured or something happened to it.
std::vector<reports::MonthOfMachine> months_of(const AssessedMachine& machine,
                                               const reports::MachineHistory& described);

/// The results of one machine that depend on each instrument and certificate.
std::vector<reports::InstrumentUse> instruments_of(const AssessedMachine& machine,
                                                   const std::filesystem::path& out);
/// Of all machines together.
std::vector<reports::InstrumentUse> joined(
    const std::vector<const std::vector<reports::InstrumentUse>*>& of_machines);

/// A quantity of a machine as it is compared with that of others: the last value that was found.
struct ComparedValue {
  std::string axis, quantity;
  Quantity unit = Quantity::deviation;
  double value = 0.0, u = 0.0;
  std::string conditions{};        ///< JSON: what must be equal, but the travel
  std::optional<double> travel{};  ///< from the first target to the last, SI
  bool rotary = false;
};
std::vector<ComparedValue> compared_of(const AssessedMachine& machine,
                                       const reports::MachineHistory& described);

struct ComparedMachine {
  const reports::MachineHistory* machine;
  const std::vector<ComparedValue>* values;
};
/// Models of three machines or more, quantity by quantity, and travels that differ by 10 % at most:
/// distance from the median in robust standard deviations (1.4826 times the median of the
/// distances). Of more than 60 machines the 60 that are furthest from it.
std::vector<reports::ModelComparison> comparisons_of(const std::vector<ComparedMachine>& machines);

}  // namespace nonio::assessment
