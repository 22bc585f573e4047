// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "laboratory/statistics/forecast.h"

/// Proposes recalibration intervals; no interval is changed automatically. ILAC-G24:2022 / OIML D
/// 10:2022 names the methods staircase (method 1), control chart (2) and statistics of similar
/// devices (5), and prescribes no numbers.
namespace nonio::statistics {

struct Proposal {
  enum class Method { staircase, control_chart, fleet };
  Method method = Method::staircase;
  std::optional<double> months{};  ///< proposed interval; none: the history does not determine an
                                   ///< interval
  /// Id of the text that states the reason, and the numbers in this text, by name.
  std::string why{};
  std::vector<std::pair<std::string, double>> numbers{};
};

/// Decision on the last result as found.
enum class Found { conforms, undecided, fails };

/// Halves the interval after a failure, and extends it after a success so that both balance at the
/// target R: (1 + a)^R (1/2)^(1-R) = 1, so 1 + a = 2^((1-R)/R) (a = 3.7 % at R = 95 %), at most 2.
/// An indeterminate result leaves the interval unchanged. `why` is the id of the reason. No interval
/// is proposed if `months` is not above 0 ("no-interval"), or if `target` is not between 0 and 1
/// ("no-target").
Proposal staircase(double months, Found, double target = 0.95);

/// Proposes the time in months from the last campaign until the one-sided 95 % bound of the
/// forecast meets the limit ("meets-limit"), but at most half of the observed span, because a
/// forecast reaches no further ("as-far-as-seen"). No interval is proposed for "few-campaigns"
/// (fewer than three, or all on one day), "out-already" (the last value or the bound is beyond the
/// limit), and "change-not-explained" (fewer than two campaigns after the last significant change,
/// which follows the point `changed_after`).
Proposal control_chart(const Series&, const Trend&, double limit,
                       std::optional<std::size_t> changed_after = {}, Beyond beyond = {});

/// Method A3 of NCSL RP-1 for n machines of one kind with one interval I. The observed reliability
/// is R0 = passed/n, the target R, and P is binomial with R. R0 below R: Q = 1 - 2 P(at most
/// `passed`), I' = I 10^((R0-R) Q), not below I/2. All passed: Q = 1 - R^n, I' = I
/// 10^((R0-R)/(1-Q)). Otherwise: Q = 1 - 2 P(`passed` or more), I' = I 10^((R0-R) Q) (derived by
/// symmetry, because RP-1 itself was not available). I' is not above 2 I. The interval is changed
/// only if Q > 0.5 and by more than 5 days. `why`: "fleet-shorter", "fleet-longer",
/// "fleet-as-it-is". No interval is proposed if `months` ("no-interval"), `target` ("no-target") or
/// the counts ("no-machines") are invalid.
Proposal fleet(double months, int passed, int machines, double target = 0.95);

}  // namespace nonio::statistics
