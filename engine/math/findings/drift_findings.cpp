// SPDX-License-Identifier: Apache-2.0
//
// docs/dev/estimators.md describes the tests. A drift of less than a fifth of A is information,
// because it is already part of the scatter; its size is extrapolated to five runs, because with
// fewer runs a larger part of the drift is in the reversal.
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/constants.h"
#include "common/finding_builder.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/distributions.h"
#include "nonio/math/drift.h"

namespace nonio::math {
namespace {

// Level of the test against the scatter within the passes: docs/dev/constants.md, A24.
constexpr double beyond_scatter = 0.002;
// Steps between five runs, to which a drift is extrapolated: docs/dev/constants.md, A25.
constexpr double steps_of_five_runs = 4.0;

// Each of the three courses that slow down has this part of the level of the even one:
// docs/dev/constants.md, M61.
constexpr double of_slowing = 0.1;

double share_of_level(const Drift& drift) {
  return std::isinf(drift.time_constant) ? 1.0 : of_slowing;
}

bool shows(double fraction, double p, double level) {
  return significant(p, level) && std::fabs(fraction - 1.0) <= 0.5;
}

bool steady(const Drift::Part& part, const Drift& drift) {
  const double level = significance * share_of_level(drift);
  if (significant(part.p_runs, level)) return true;
  const bool by_passes = std::isinf(drift.time_constant)
                             ? drift.runs >= 5 && part.monotone
                             : part.monotone && shows(part.seen_in_pairs, part.p_pairs, level);
  return by_passes && significant(part.p_passes, level);
}

bool parallel_found(const Drift& drift) {
  const Drift::Part& part = drift.offset;
  const double level = share_of_level(drift);
  if (!part.known || !significant(part.p_scatter, beyond_scatter * level)) return false;
  const bool shown = shows(drift.seen_in_reversal, drift.p_reversal, significance * level);
  return steady(part, drift) || (shown && part.agree);
}

bool wedge_found(const Drift& drift) {
  const Drift::Part& part = drift.slope;
  const double level = share_of_level(drift);
  if (!part.known || !significant(part.p_scatter, beyond_scatter * level)) return false;
  return steady(part, drift) ||
         (part.agree && (drift.runs == 2 || significant(part.p_passes, significance * level)));
}

// Of the courses with which a drift is found, the one that fits best; without one the even course.
const Drift& course_of(const std::vector<Drift>& drifts) {
  const Drift* best = nullptr;
  for (const Drift& drift : drifts)
    if ((parallel_found(drift) || wedge_found(drift)) &&
        (best == nullptr || drift.misfit() < best->misfit()))
      best = &drift;
  return best != nullptr ? *best : drifts.front();
}

double smallest_p(const Drift::Part& part) {
  return std::max(part.p_scatter, std::min({part.p_runs, part.p_passes, significance}));
}

}  // namespace

void drift_findings(const AxisTest& test, std::vector<Finding>& findings,
                    ReversalUncertainty of_budget) {
  const std::vector<Drift> drifts = estimate_drifts(test);
  if (drifts.empty()) return;
  const Drift& drift = course_of(drifts);
  const double steps = static_cast<double>(drift.runs) - 1.0;
  const double scatter = std::max(drift.scatter, rounding);
  const Drift::Part &shift = drift.offset, &turn = drift.slope;
  const double wedge = turn.total * test.length();
  const double near = shift.total + turn.total * (test.targets.front() - drift.middle);
  const double far = shift.total + turn.total * (test.targets.back() - drift.middle);
  const double largest = std::max(std::fabs(near), std::fabs(far));
  const double common = near * far > 0.0 ? std::min(std::fabs(near), std::fabs(far)) : 0.0;

  const bool is_wedge =
      wedge_found(drift) && std::fabs(wedge) > scatter && std::fabs(wedge) >= 0.25 * largest;
  const bool is_parallel = parallel_found(drift) && std::fabs(shift.total) > scatter &&
                           (!is_wedge || common > std::max(scatter, 0.5 * std::fabs(wedge)));
  const auto finding = [&](const char* id, double total, const Drift::Part& part) {
    const double per_run = total / steps;
    const double size = std::max(std::fabs(total), steps_of_five_runs * std::fabs(per_run));
    return FindingBuilder(id, matters(test, size), test.rotary)
        .deviation("total", total)
        .deviation("per_run", per_run)
        .slope("wedge", turn.total)
        .deviation("in_B", std::max(drift_share(test).B_mean, of_budget.B_mean))
        .deviation("scatter", scatter)
        .number("p", smallest_p(part), Quantity::probability)
        .count("runs", static_cast<double>(drift.runs))
        .done();
  };
  if (is_parallel) findings.push_back(finding("drift.parallel", shift.total, shift));
  if (is_wedge) findings.push_back(finding("drift.wedge", wedge, turn));
}

}  // namespace nonio::math
