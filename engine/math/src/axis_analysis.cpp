// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/axis_analysis.h"

#include <cmath>

#include "nonio/math/axis_findings.h"

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
        "wanted the readings of axis '" + in.measurement.axis + "', found " +
        (o.axes.empty() ? std::string("no axis") : "those of '" + o.axes.front().axis + "'"));
  if (o.angular != o.axes.front().rotary)
    return fail(o.angular ? "wanted deviations of length on the linear axis '" +
                                in.measurement.axis + "', found angles"
                          : "wanted deviations of angle on the rotary axis '" +
                                in.measurement.axis + "', found lengths");
  const AxisTest all = AxisTest::arrange(o);
  if (all.targets.empty()) return fail("wanted readings with a direction of approach, found none");

  AxisAnalysis a;
  a.test = choose_targets(all, in.options.text("incomplete_targets") == "leave-out", a.findings);
  a.deviation = deviation_of(a.test.rotary);
  a.position = position_of(a.test.rotary);
  a.approaches = approaches_behind_means(a.test);
  for (Finding& f : axis_findings(a.test, o, in.campaign.machine.axis(in.measurement.axis)))
    a.findings.push_back(std::move(f));
  const BudgetOrGap of = uncertainty_budget(in.campaign, in.measurement.axis, a.test);
  a.budget = of.budget;
  a.findings.push_back(budget_finding(of, a.test.rotary));
  return a;
}

void add_value(Evaluation& e, const AxisAnalysis& a, std::string name, double value, double U) {
  if (!std::isfinite(value)) return;
  Value v{std::move(name), value, a.deviation};
  if (a.budget && std::isfinite(U)) v.U = U;
  e.values.push_back(std::move(v));
}

}  // namespace nonio::math
