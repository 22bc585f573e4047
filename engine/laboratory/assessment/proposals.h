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

/// Target share of machines that are in tolerance when they are measured again.
inline constexpr double reliability_target = 0.95;
/// Smallest number of machines of one model and interval that are assessed together.
inline constexpr std::size_t fewest_of_a_fleet = 5;

/// Data of one machine from which intervals are proposed.
struct IntervalFacts {
  std::string maker, model;
  std::uint64_t days = 0;  ///< number of days on which the machine was measured
  double months = 0.0;     ///< calibration interval in months; 0: none
  double tested = 0.0;     ///< months from the previous day of measurement to the campaign of
                           ///< `found`; 0: none
  /// Worst decision among the last results as found of all quantities with a limit.
  std::optional<nonio::statistics::Found> found{};
  std::optional<reports::IntervalProposal> chart{};    ///< shortest interval that the machine's own
                                                       ///< readings allow
  std::optional<reports::IntervalProposal> refusal{};  ///< reason why the machine's own readings
                                                       ///< give no interval
  std::optional<reports::IntervalProposal> out_now{};  ///< the worst value that is beyond its limit
                                                       ///< today
};

/// Collects the data of a machine. `rule`: interval by the site's rule in months; none: the usual
/// interval applies.
IntervalFacts interval_facts(const AssessedMachine& machine, std::optional<int> rule);

/// Proposes an interval for each machine, in whole months; nothing is changed. The proposal is
/// based on all machines of a model (NCSL RP-1, A3) if there are enough, otherwise on the last
/// calibration as found (staircase). After a failure it is not longer than the staircase, and never
/// longer than the control chart of the quantities with a limit. A calibration before 75 % of the
/// interval does not test the interval. No interval is proposed, and the reason is stated, for a
/// value beyond its limit today, for fewer than two days of measurement, without a limit or an
/// interval, and, except after a failure, for fewer than two campaigns after the last change.
std::vector<reports::IntervalProposal> proposals_of(
    const std::vector<const IntervalFacts*>& machines);

}  // namespace nonio::assessment
