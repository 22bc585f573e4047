// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "laboratory/statistics/forecast.h"

/// Proposes recalibration intervals without changing any. ILAC-G24:2022 / OIML D 10:2022 names the
/// methods staircase (1), control chart (2) and statistics of similar devices (5), but prescribes
/// no numbers.
namespace nonio::statistics {

struct Proposal {
  enum class Method { staircase, control_chart, fleet };
  Method method = Method::staircase;
  std::optional<double> months{};  ///< proposed interval, if the history determines one
  /// Id of the text with the reason, and the numbers in this text by name.
  std::string why{};
  std::vector<std::pair<std::string, double>> numbers{};
};

/// Decision on the last result as found.
enum class Found { conforms, undecided, fails };

/// Halves the interval after a failure and extends it by a after a success, so that both balance at
/// the target R: (1 + a)^R (1/2)^(1-R) = 1, 1 + a = 2^((1-R)/R), at most 2 (a = 3.7 % for R = 95
/// %). An indeterminate result does not change the interval. `why` is "no-interval" if `months` is
/// not positive, "no-target" if `target` is not between 0 and 1.
Proposal staircase(double months, Found, double target = 0.95);

/// Proposes the months until the one-sided 95 % bound of the forecast meets the limit
/// ("meets-limit"), at most half of the time span ("as-far-as-seen"). No interval for
/// "few-campaigns" (fewer than three, or all on one date), "out-already" (last value or bound
/// beyond the limit) and "change-not-explained" (fewer than two campaigns after the last
/// significant change, which follows point `changed_after`).
Proposal control_chart(const Series&, const Trend&, double limit,
                       std::optional<std::size_t> changed_after = {}, Beyond beyond = {});

/// Method A3 of NCSL RP-1 for n machines of one kind with one interval I, target R and observed
/// reliability R0 = passed/n; P is binomial with R. R0 below R: Q = 1 - 2 P(at most `passed`), I' =
/// I 10^((R0-R) Q), not below I/2. All passed: Q = 1 - R^n, I' = I 10^((R0-R)/(1-Q)). Otherwise: Q
/// = 1 - 2 P(`passed` or more), I' = I 10^((R0-R) Q) (by symmetry, because RP-1 itself was not
/// available). I' is not above 2 I. I changes only if Q > 0.5 and by more than 5 days. `why` is
/// "fleet-shorter", "fleet-longer" or "fleet-as-it-is"; for invalid arguments "no-interval",
/// "no-target" or "no-machines".
Proposal fleet(double months, int passed, int machines, double target = 0.95);

}  // namespace nonio::statistics
