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

/// Findings about the readings of an axis, in addition to the values of a standard.
/// docs/formulas.md contains the tests with their formulas, levels (1 %) and required numbers of
/// readings; the texts are in templates/words. No errors: a test that the readings do not allow
/// gives no finding. Evidence is SI.
namespace nonio::math {

/// Returns all findings that do not depend on the standard: about drift, reversal, scatter, suspect
/// readings, a rotary axis after a whole turn, an offset common to all targets, and deviations from
/// the test plan of ISO 230-2. U_mean: expanded uncertainty of the mean reversal by the budget, m
/// or rad; 0: not known.
std::vector<Finding> axis_findings(const AxisTest&, const Observations&, const Axis* axis,
                                   double U_mean = 0.0);

/// This function, `scatter_findings`, `suspect_findings` and `plan_findings` append the findings of
/// one topic each; those about scatter include those about suspect readings.
void drift_findings(const AxisTest&, std::vector<Finding>&);
/// Appends the findings about the reversal. `active`: backlash value of the control during the
/// measurement, m or rad, if it is stated.
void reversal_findings(const AxisTest&, std::vector<Finding>&,
                       std::optional<double> active = std::nullopt, double U_mean = 0.0);
void scatter_findings(const AxisTest&, std::vector<Finding>&);
void suspect_findings(const AxisTest&, std::vector<Finding>&);
/// Appends a finding if a position of a rotary axis has another deviation when it is approached
/// again after a whole turn.
void turn_findings(const AxisTest&, std::vector<Finding>&);
void plan_findings(const AxisTest&, const Observations&, const Axis* axis, std::vector<Finding>&);

/// Returns whether a deviation of this size, m or rad, is relevant: at least a fifth of A (of E if
/// A is not determined). It is also relevant if neither is determined.
bool matters(const AxisTest&, double size);

/// Returns whether the expanded uncertainty U is less than half of the mean reversal. Only then
/// does a backlash value derived from the mean improve the machine more than its error can impair
/// it.
bool is_reversal_known(double mean, double U);

/// Returns whether the scatter of the two directions differs significantly, by the test of the
/// finding repeatability.asymmetric.
bool scatter_is_asymmetric(const AxisTest&);

/// Indices of targets that do not contribute to every value. `unpaired`: not approached from every
/// direction that occurs. `single`: approached only once from a direction, in a test with repeated
/// approaches.
struct Incomplete {
  std::vector<std::size_t> unpaired, single;
  bool any() const { return !unpaired.empty() || !single.empty(); }
};
Incomplete incomplete_targets(const AxisTest&);

/// Returns the test to be evaluated. It contains all targets, or if `leave_out`, only those that
/// contribute to every value, provided that at least two of them exist. If some targets do not
/// contribute to every value, findings list them and state their treatment.
AxisTest choose_targets(const AxisTest&, bool leave_out, std::vector<Finding>&);

/// Returns the finding `uncertainty.budget` (`uncertainty.budget-angle` for a rotary axis) with the
/// contributions, or if there is no budget, `uncertainty.no-data` with the missing keys.
Finding budget_finding(const BudgetOrGap&, bool rotary);

/// Returns the positions of these targets, at most the first 12, as text: "100; 250 mm".
std::string target_list(const AxisTest&, const std::vector<std::size_t>& targets);

}  // namespace nonio::math
