// SPDX-License-Identifier: Apache-2.0
// VDI/DGQ 3441: statistical testing of positional accuracy of a linear or rotary axis.
#include <cmath>

#include "nonio/math/axis_analysis.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/reversal.h"
#include "nonio/math/vdi3441.h"
#include "nonio/sdk/plugin.h"

namespace nonio::vdi_dgq_3441 {

using namespace math;

namespace {

bool applies(const Campaign&, const Measurement& m) { return m.kind == "axis"; }

void add_values(Evaluation& e, const AxisAnalysis& a, const VdiResult& r) {
  const VdiUncertainty U = vdi3441_uncertainty(a.budget.value_or(Budget{}), a.approaches);
  add_value(e, a, "P", r.P, U.P, Made::of_all);
  add_value(e, a, "Pa", r.Pa, U.Pa, Made::of_all);
  add_value(e, a, "Ps_max", r.Ps_max, U.Ps_max, Made::of_environment);
  add_value(e, a, "Ps_mean", r.Ps_mean, U.Ps_mean, Made::of_environment);
  add_value(e, a, "U_max", r.U_max, U.U_max, Made::of_environment);
  add_value(e, a, "U_mean", r.U_mean, U.U_mean, Made::of_environment);
}

PointTable table(const AxisAnalysis& a, const VdiResult& r) {
  const VdiUncertainty U = vdi3441_uncertainty(a.budget.value_or(Budget{}), a.approaches);
  PointTable points;
  const auto column = [&](const char* name, Quantity quantity, double uncertainty, auto value_of) {
    PointTable::Column c{name, quantity, {}};
    for (const VdiPoint& p : r.points) c.values.push_back(value_of(p));
    if (a.budget && std::isfinite(uncertainty)) c.U = uncertainty;
    points.columns.push_back(std::move(c));
  };
  column("target", a.position, NAN, [](const VdiPoint& p) { return p.target; });
  column("mean", a.deviation, U.Pa, [](const VdiPoint& p) { return p.mean; });
  column("S", a.deviation, U.Ps_max / 6.0, [](const VdiPoint& p) { return p.S; });
  column("U", a.deviation, U.U_max, [](const VdiPoint& p) { return p.U; });
  column("Ps", a.deviation, U.Ps_max, [](const VdiPoint& p) { return p.Ps; });
  return points;
}

void name_absent(std::vector<Finding>& findings) {
  for (Finding& f : findings)
    for (auto& [name, text] : f.texts)
      if (name == "absent")
        text =
            f.id == "runs.single" ? "P, Ps_max, Ps_mean" : "P, Pa, Ps_max, Ps_mean, U_max, U_mean";
}

void hidden(const AxisAnalysis& a, const VdiResult& vdi, Evaluation& e) {
  const Iso230Result iso = evaluate_iso230_2(a.test, 2.0);
  if (scatter_is_asymmetric(a.test) && std::isfinite(iso.R_plus) && std::isfinite(iso.R_minus) &&
      std::isfinite(vdi.Ps_max))
    e.findings.push_back({"vdi.hides-direction",
                          false,
                          {{"R+", iso.R_plus, a.deviation},
                           {"R-", iso.R_minus, a.deviation},
                           {"Ps_max", vdi.Ps_max, a.deviation},
                           {"Ps_mean", vdi.Ps_mean, a.deviation}}});
  bool positive = false, negative = false;
  for (const auto& p : iso.points) {
    positive = positive || p.B > 0.0;
    negative = negative || p.B < 0.0;
  }
  if (positive && negative && std::fabs(iso.B_mean) < 0.5 * vdi.U_mean &&
      assess_reversal(a.test).kind == Reversal::Kind::not_constant)
    e.findings.push_back({"vdi.hides-sign",
                          false,
                          {{"B_mean", iso.B_mean, a.deviation},
                           {"B", iso.B, a.deviation},
                           {"U_mean", vdi.U_mean, a.deviation},
                           {"U_max", vdi.U_max, a.deviation}}});
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  NONIO_TRY(auto begun, begin_axis_analysis(in));
  const bool from_range = in.options.text("standard_deviation") == "from-range";
  const VdiResult result = evaluate_vdi3441(
      begun.test, from_range ? StandardDeviation::from_range : StandardDeviation::direct);
  Evaluation e;
  add_values(e, begun, result);
  e.points = table(begun, result);
  e.findings = std::move(begun.findings);
  name_absent(e.findings);
  if (from_range && begun.test.most_approaches() > 10)
    e.findings.push_back(
        {"vdi.range-of-too-many",
         true,
         {{"readings", static_cast<double>(begun.test.most_approaches()), Quantity::count}}});
  hidden(begun, result, e);
  for (Finding& f : e.findings) f.measurement = in.measurement.id;
  e.notes.push_back({from_range ? "method.vdi-from-range" : "method.vdi-direct"});
  if (begun.budget) e.notes.push_back({"method.vdi-uncertainty"});
  note_scatter(e, begun, "P, Ps_max, Ps_mean");
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"vdi-dgq-3441",
            "1.0.0",
            "Positional accuracy according to VDI/DGQ 3441.",
            {one_of({"direct", "from-range"},
                    {"standard_deviation", std::string("direct"), "",
                     "Standard deviation 'direct' from n - 1, or 'from-range' with d_n."}),
             incomplete_targets_option()}};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::vdi_dgq_3441
