// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "laboratory/statistics/forecast.h"

/// When to measure next: proposals, never a change by itself. Nothing numerical is prescribed by
/// ILAC-G24:2022 / OIML D 10:2022, which names the kinds: staircase (its method 1), control chart
/// (2), and statistics of many like devices (5).
namespace nonio::statistics {

struct Proposal {
  enum class Method { staircase, control_chart, fleet };
  Method method = Method::staircase;
  std::optional<double> months{};  ///< none: not determined by this history
  /// Why: id of a word, and the numbers that belong to it, by name.
  std::string why{};
  std::vector<std::pair<std::string, double>> numbers{};
};

/// Decision of the last campaign as found.
enum class Found { conforms, undecided, fails };

/// Half the interval after a failure; after a success so much longer that both balance at the
/// target: (1 + a)^R (1/2)^(1-R) = 1, so 1 + a = 2^((1-R)/R) (3.7 % at 95 %). Indeterminate:
/// unchanged. Why: "passed", "failed"; none for "no-interval", "no-target".
Proposal staircase(double months, Found, double target = 0.95);

/// From the machine's own readings: the day on which the one-sided 95 % bound of the forecast meets
/// the limit ("meets-limit"), but not farther than the forecast may look, half the observed span
/// ("as-far-as-seen"). None: "few-campaigns" (three), "out-already", "change-not-explained" (after
/// the last significant change, which follows the point `changed_after`, there are fewer than two
/// campaigns).
Proposal control_chart(const Series&, const Trend&, double limit,
                       std::optional<std::size_t> changed_after = {}, Beyond beyond = {});

/// Method A3 of NCSL RP-1 for machines of one kind with one interval: `passed` of `machines` were
/// in tolerance. Observed reliability R0 = passed/machines. Below the target: Q = 1 - 2 B(passed;
/// machines, R), I' = I 10^((R0-R) Q), not below I/2. All passed: Q = 1 - R^n, I' =
/// I 10^((R0-R)/(1-Q)). Above the target, not all: Q = 1 - 2 P(passed or more), I' = I 10^((R0-R)
/// Q) (derived by symmetry: RP-1 itself was not readable). Not above 2 I. A change only where Q >
/// 0.5 and by more than 5 days. Why: "fleet-shorter", "fleet-longer", "fleet-as-it-is"; none:
/// "no-interval", "no-target", "no-machines".
Proposal fleet(double months, int passed, int machines, double target = 0.95);

}  // namespace nonio::statistics
