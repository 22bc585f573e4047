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

bool steady(const Drift::Part& part, std::size_t runs) {
  return significant(part.p_runs, significance) ||
         (runs >= 5 && part.monotone && significant(part.p_passes, significance));
}

bool parallel_found(const Drift& drift) {
  const Drift::Part& part = drift.offset;
  if (!part.known || !significant(part.p_scatter, beyond_scatter)) return false;
  const bool shown =
      significant(drift.p_reversal, significance) && std::fabs(drift.seen_in_reversal - 1.0) <= 0.5;
  return steady(part, drift.runs) || (shown && part.agree);
}

bool wedge_found(const Drift& drift) {
  const Drift::Part& part = drift.slope;
  if (!part.known || !significant(part.p_scatter, beyond_scatter)) return false;
  return steady(part, drift.runs) ||
         (part.agree && (drift.runs == 2 || significant(part.p_passes, significance)));
}

double smallest_p(const Drift::Part& part) {
  return std::max(part.p_scatter, std::min({part.p_runs, part.p_passes, significance}));
}

}  // namespace

void drift_findings(const AxisTest& test, std::vector<Finding>& findings) {
  const Drift drift = estimate_drift(test);
  if (!drift.offset.known) return;
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
  const auto finding = [&](const char* id, double total, const Drift::Part& part, double per_run) {
    const double size = std::max(std::fabs(total), steps_of_five_runs * std::fabs(per_run));
    return FindingBuilder(id, matters(test, size), test.rotary)
        .deviation("total", total)
        .deviation("per_run", per_run)
        .slope("wedge", turn.total)
        .deviation("in_B", std::fabs(drift.in_B_mean))
        .deviation("scatter", scatter)
        .number("p", smallest_p(part), Quantity::probability)
        .count("runs", static_cast<double>(drift.runs))
        .done();
  };
  if (is_parallel) findings.push_back(finding("drift.parallel", shift.total, shift, shift.per_run));
  if (is_wedge)
    findings.push_back(finding("drift.wedge", wedge, turn, turn.per_run * test.length()));
}

}  // namespace nonio::math
