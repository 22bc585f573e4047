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

/// Share of machines that are to be in tolerance when they are measured again.
inline constexpr double reliability_target = 0.95;
/// So many machines of one model and interval are judged together.
inline constexpr std::size_t fewest_of_a_fleet = 5;

/// What one machine has to do with the proposals of a site.
struct IntervalFacts {
  std::string maker, model;
  std::uint64_t days = 0;  ///< on which it was measured
  double months = 0.0;     ///< its interval; 0: none
  double tested = 0.0;     ///< months that lay before what was found last
  /// What each axis was when it was last found: the worst of all that has a limit.
  std::optional<nonio::statistics::Found> found{};
  std::optional<reports::IntervalProposal> chart{};    ///< the shortest of its own readings
  std::optional<reports::IntervalProposal> refusal{};  ///< why its own readings give none
  std::optional<reports::IntervalProposal> out_now{};  ///< a value is beyond its limit today
};

/// `rule`: months of the site's rule for it; else the usual interval.
IntervalFacts interval_facts(const AssessedMachine& machine, std::optional<int> rule);

/// When to measure each machine next, in whole months; nothing is changed by it. What many machines
/// of its model show (A3), else what its last calibration as found showed (staircase); after a
/// failure not more than the staircase; never longer than the control chart of what has a limit. A
/// machine that was measured well before its interval was over has not shown that it is good for it.
/// Refused by name where a value is beyond its limit today, where there are fewer than two campaigns, no limit or no interval, and where the
/// last change has fewer than two campaigns behind it.
std::vector<reports::IntervalProposal> proposals_of(
    const std::vector<const IntervalFacts*>& machines);

}  // namespace nonio::assessment
