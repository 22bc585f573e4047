// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/compensated.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nonio/math/along.h"
#include "nonio/math/budget.h"
#include "nonio/math/drift.h"
#include "nonio/math/uncertainty.h"

namespace nonio::math {

static constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

CompensatedUncertainty compensated_uncertainty(const Campaign& campaign, const Measurement& m,
                                               const Observations& readings, const AxisTest& test,
                                               bool has_drift) {
  const Observations* own = &readings;
  const auto limits = limits_held(campaign, {&own, 1});
  auto budget = uncertainty_budget(campaign, limits.environment, m.axis, test).budget;
  if (budget && !has_drift) budget->seen = {};
  const DriftShare seen = has_drift ? drift_share(test) : DriftShare{};
  if (budget) budget->seen.E = seen.E_after, budget->seen.M = seen.M_after;
  if (!budget) return {seen.B_mean, seen.B, not_known, not_known};
  const auto U = iso230_2_uncertainty(*budget, approaches_per_mean(test), 2.0);
  return {std::max(U.B_mean.U, seen.B_mean), std::max(U.B.U, seen.B), U.E, U.M};
}

double compensated_uncertainty_along(const Campaign& campaign, const Measurement& m,
                                     const Observations& readings) {
  const Observations line = along_diagonal(readings, m);
  if (readings.size() == 0 || line.axes.front().approach.size() != readings.size())
    return not_known;
  const AxisTest test = AxisTest::arrange(line);
  const Observations* own = &readings;
  const auto budget =
      budget_along(campaign, limits_held(campaign, {&own, 1}).environment, m, test).budget;
  return budget ? iso230_2_uncertainty(*budget, approaches_per_mean(test), 2.0).E : not_known;
}

double predicted_after(double before, double after, double U) {
  return after < before && !std::isnan(U) ? std::min(before, std::max(after, U)) : after;
}

double predicted_E_after(double before, double after, double U, double U_B, double B_after) {
  return std::max(predicted_after(before, after, std::max(U, U_B)), B_after);
}

}  // namespace nonio::math
