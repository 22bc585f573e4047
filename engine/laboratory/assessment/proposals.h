// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/assessment/series.h"
#include "laboratory/statistics/intervals.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Target fraction of machines in tolerance at their next calibration.
inline constexpr double reliability_target = 0.95;
/// Smallest number of machines of one model and interval that are assessed together.
inline constexpr std::size_t fewest_of_a_fleet = 5;

/// Data of one machine for the proposal of an interval.
struct IntervalFacts {
  std::string maker, model;
  std::uint64_t days = 0;  ///< number of dates with a measurement
  double months = 0.0;     ///< calibration interval; 0 without one
  /// Months from the previous date of measurement to the campaign of `found`; 0 without one.
  double tested = 0.0;
  /// Worst decision among the last results as found of all quantities with a limit.
  std::optional<nonio::statistics::Found> found{};
  /// Shortest interval that the control charts support.
  std::optional<reports::IntervalProposal> chart{};
  /// Reason why the control charts give no interval.
  std::optional<reports::IntervalProposal> refusal{};
  /// Worst value that is out of tolerance today.
  std::optional<reports::IntervalProposal> out_now{};
};

/// `rule` is the interval in months according to site.toml; without a rule, the usual interval
/// applies.
IntervalFacts interval_facts(const AssessedMachine& machine, std::optional<int> rule);

/// Proposes an interval in whole months for each machine, from all machines of a model (NCSL RP-1,
/// A3) if there are enough, otherwise from the last calibration as found (staircase). The control
/// charts of quantities with a limit can only shorten it. A calibration before 75 % of the interval
/// does not test the interval. Without an interval, `why` contains the reason.
std::vector<reports::IntervalProposal> proposals_of(
    const std::vector<const IntervalFacts*>& machines);

}  // namespace nonio::assessment
