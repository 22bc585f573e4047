// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/math/uncertainty.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/plugin.h"
#include "nonio/sdk/results.h"

/// Findings about the readings of an axis. docs/dev/estimators.md contains the tests with their
/// levels (1 %) and the required numbers of readings; a test that the readings do not allow gives
/// no finding. Evidence is SI.
namespace nonio::math {

/// Expanded uncertainties of the reversal by the budget, m or rad; 0: not known.
struct ReversalUncertainty {
  double B = 0.0, B_mean = 0.0;
};

/// Returns all findings that do not depend on the standard.
std::vector<Finding> axis_findings(const AxisTest&, const Observations&, const Axis* axis,
                                   ReversalUncertainty = {});

/// Each function below appends findings of one topic; scatter_findings includes suspect readings.
void drift_findings(const AxisTest&, std::vector<Finding>&, ReversalUncertainty = {});
/// `active`: backlash value of the control during the measurement, m or rad, if it is stated.
void reversal_findings(const AxisTest&, std::vector<Finding>&,
                       std::optional<double> active = std::nullopt, ReversalUncertainty = {});
void scatter_findings(const AxisTest&, std::vector<Finding>&);
void suspect_findings(const AxisTest&, std::vector<Finding>&);
/// Compares the deviations of a rotary axis at positions that are one turn apart.
void turn_findings(const AxisTest&, std::vector<Finding>&);
void plan_findings(const AxisTest&, const Observations&, const Axis* axis, std::vector<Finding>&);

/// Returns whether a deviation, m or rad, is at least a fifth of A (of E if A is not determined).
/// True if neither is determined.
bool matters(const AxisTest&, double size);

/// Returns whether U is less than half of the mean reversal. Otherwise the error of a backlash
/// value can impair the machine more than the value improves it.
bool is_reversal_known(double mean, double U);

/// Applies the test of the finding repeatability.asymmetric.
bool scatter_is_asymmetric(const AxisTest&);

/// Targets that do not contribute to every value. `unpaired`: a direction that occurs is missing.
/// `single`: approached only once from a direction, in a test with repeated approaches.
struct Incomplete {
  std::vector<std::size_t> unpaired, single;
  bool any() const { return !unpaired.empty() || !single.empty(); }
};
Incomplete incomplete_targets(const AxisTest&);

/// Returns all targets, or if `leave_out`, those that contribute to every value, provided that
/// there are at least two. Findings list the other targets.
AxisTest choose_targets(const AxisTest&, bool leave_out, std::vector<Finding>&);

/// With one approach to each target, the contribution of the scatter to every result is not known.
/// Then removes the budget, so that no result has a U, and reports `runs.single`. `absent`: results
/// that do not exist without scatter.
void require_repetition(const AxisTest&, std::optional<Budget>&, const char* absent,
                        std::vector<Finding>&);

/// Returns `uncertainty.budget` (`uncertainty.budget-angle` for a rotary axis), or without a budget
/// `uncertainty.no-data` with the missing keys.
Finding budget_finding(const BudgetOrGap&, bool rotary);

/// Returns the positions of these targets, at most the first 12, as text: "100; 250 mm".
std::string target_list(const AxisTest&, const std::vector<std::size_t>& targets);

}  // namespace nonio::math
