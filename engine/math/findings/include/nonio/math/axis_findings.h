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

/// What the readings of an axis show in addition to the values of a standard. docs/formulas.md has
/// the tests with their formulas, levels (1 %) and least numbers of readings; the words are in
/// templates/words. No errors: what these readings cannot show gives no finding. Evidence is SI.
namespace nonio::math {

/// Everything that does not depend on the standard: drift, reversal, scatter, suspected readings,
/// what was not measured, and deviations from the test plan of ISO 230-2. U_mean: of the mean
/// reversal by the budget, m or rad; 0: not known.
std::vector<Finding> axis_findings(const AxisTest&, const Observations&, const Axis* axis,
                                   double U_mean = 0.0);

/// The parts of the list above.
void drift_findings(const AxisTest&, std::vector<Finding>&);
/// active: the backlash value of the control during the measurement, where it is stated; m or rad.
void reversal_findings(const AxisTest&, std::vector<Finding>&,
                       std::optional<double> active = std::nullopt, double U_mean = 0.0);
void scatter_findings(const AxisTest&, std::vector<Finding>&);
void suspect_findings(const AxisTest&, std::vector<Finding>&);
/// Rotary: whether a place that is met again after a whole turn deviates as it did.
void turn_findings(const AxisTest&, std::vector<Finding>&);
void plan_findings(const AxisTest&, const Observations&, const Axis* axis, std::vector<Finding>&);

/// Whether a deviation of this size is worth acting on: from a fifth of A on (of E without A).
bool matters(const AxisTest&, double size);

/// Whether a backlash value made from this mean reversal, with U of it, corrects more than it may
/// spoil: U is less than half of it.
bool is_reversal_known(double mean, double U);

/// Whether the scatter of the two directions differs (see repeatability.asymmetric).
bool scatter_is_asymmetric(const AxisTest&);

/// Targets that do not give every value: not reached from each direction that occurs, or once
/// where others were reached more often.
struct Incomplete {
  std::vector<std::size_t> unpaired, single;
  bool any() const { return !unpaired.empty() || !single.empty(); }
};
Incomplete incomplete_targets(const AxisTest&);

/// What an analysis evaluates: all targets, or (`leave_out`) the complete ones; the finding states
/// which targets were concerned and what was done.
AxisTest choose_targets(const AxisTest&, bool leave_out, std::vector<Finding>&);

/// `uncertainty.budget` with its parts, or `uncertainty.no-data` with the missing keys.
Finding budget_finding(const BudgetOrGap&, bool rotary);

/// "100, 250 mm"
std::string target_list(const AxisTest&, const std::vector<std::size_t>& targets);

}  // namespace nonio::math
