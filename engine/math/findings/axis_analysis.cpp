// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/axis_analysis.h"

#include <cmath>

#include "nonio/math/axis_findings.h"
#include "nonio/math/budget.h"

namespace nonio::math {

Option incomplete_targets_option() {
  return {"incomplete_targets",
          std::string("refuse"),
          "",
          "Targets not reached from both directions, or once only: 'refuse' the values of the "
          "whole axis, or 'leave-out' these targets.",
          {"refuse", "leave-out"}};
}

Expected<AxisAnalysis> begin_axis_analysis(const AnalysisInput& in) {
  const Observations& o = in.observations;
  if (o.axes.empty() || o.axes.front().axis != in.measurement.axis)
    return fail(
        "expected the readings of axis '" + in.measurement.axis + "', found " +
        (o.axes.empty() ? std::string("no axis") : "those of '" + o.axes.front().axis + "'"));
  if (o.angular != o.axes.front().rotary)
    return fail(o.angular ? "expected deviations of length on the linear axis '" +
                                in.measurement.axis + "', found angles"
                          : "expected deviations of angle on the rotary axis '" +
                                in.measurement.axis + "', found lengths");
  const AxisTest all = AxisTest::arrange(o);
  if (all.targets.empty())
    return fail("expected readings with a direction of approach, found none");

  AxisAnalysis a;
  a.axis = in.measurement.axis;
  a.test = choose_targets(all, in.options.text("incomplete_targets") == "leave-out", a.findings);
  a.deviation = deviation_of(a.test.rotary);
  a.position = position_of(a.test.rotary);
  a.approaches = approaches_per_mean(a.test);
  const Axis* stated = in.campaign.machine.axis(in.measurement.axis);
  Axis axis = stated != nullptr ? *stated : Axis{};
  if (in.measurement.compensation == "off") axis.active_backlash = 0.0;
  const Observations* own = &o;
  HeldLimits limits = limits_held(in.campaign, {&own, 1});
  const BudgetOrGap of =
      uncertainty_budget(in.campaign, limits.environment, in.measurement.axis, a.test);
  a.budget = of.budget;
  const Iso230Uncertainty U = iso230_2_uncertainty(a.budget.value_or(Budget{}), a.approaches, 2.0);
  const ReversalUncertainty of_reversal =
      a.budget ? ReversalUncertainty{U.B, U.B_mean} : ReversalUncertainty{};
  for (Finding& f : axis_findings(a.test, o, stated != nullptr ? &axis : nullptr, of_reversal))
    a.findings.push_back(std::move(f));
  for (Finding& f : limits.findings) a.findings.push_back(std::move(f));
  require_repetition(a.test, a.budget, "R, R+, R-, A, A+, A-", a.findings);
  if (a.budget || !of.budget) a.findings.push_back(budget_finding(of, a.test.rotary));
  if (a.budget && a.budget->U_EVE == 0.0)
    a.findings.push_back({.id = "uncertainty.zero",
                          .attention = true,
                          .texts = {{"missing", a.test.rotary ? "environment.drift_arcsec"
                                                              : "environment.drift_um"}}});
  return a;
}

void add_value(Evaluation& e, const AxisAnalysis& a, std::string name, double value,
               const ResultUncertainty& U, Made made) {
  if (!std::isfinite(value)) return;
  Value v{std::move(name), value, a.deviation};
  if (a.budget && std::isfinite(U.U) && U.U > 0.0) {
    v.U = U.U;
    if (!e.budget) e.budget = contributions_of(*a.budget, a.axis, a.test.rotary);
    e.budget->results.push_back(
        {v.name, a.deviation, shares_of(*a.budget, U, made == Made::of_all), 2.0, INFINITY});
  }
  e.values.push_back(std::move(v));
}

void note_scatter(Evaluation& e, const AxisAnalysis& a, std::string values) {
  if (!a.budget || a.budget->U_EVE == 0.0 || a.approaches < 2) return;
  const double n = static_cast<double>(a.approaches);
  e.notes.push_back({"method.scatter-of-runs",
                     {{"approaches", n, Quantity::count},
                      {"percent", std::round(100.0 / std::sqrt(2.0 * (n - 1.0))), Quantity::count}},
                     {{"values", std::move(values)}}});
}

}  // namespace nonio::math
