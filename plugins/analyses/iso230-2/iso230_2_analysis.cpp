// SPDX-License-Identifier: Apache-2.0
// ISO 230-2: accuracy and repeatability of positioning of a linear or rotary axis.
#include <cmath>

#include "nonio/math/axis_analysis.h"
#include "nonio/math/iso230_2.h"
#include "nonio/sdk/plugin.h"

namespace nonio::iso230_2 {

using namespace math;

namespace {

double coverage_factor(std::int64_t edition) { return edition == 1988 ? 3.0 : 2.0; }

bool applies(const Campaign&, const Measurement& m) { return m.kind == "axis"; }

void add_values(Evaluation& e, const AxisAnalysis& a, const Iso230Result& r) {
  const Iso230Uncertainty U = iso230_2_uncertainty(a.budget.value_or(Budget{}), a.approaches, r.k);
  add_value(e, a, "A", r.A, U.A, Made::of_all);
  add_value(e, a, "A+", r.A_plus, U.A_plus, Made::of_all);
  add_value(e, a, "A-", r.A_minus, U.A_minus, Made::of_all);
  add_value(e, a, "E", r.E, U.E, Made::of_all);
  add_value(e, a, "E+", r.E_plus, U.E_plus, Made::of_all);
  add_value(e, a, "E-", r.E_minus, U.E_minus, Made::of_all);
  add_value(e, a, "M", r.M, U.M, Made::of_all);
  add_value(e, a, "R", r.R, U.R, Made::of_environment);
  add_value(e, a, "R+", r.R_plus, U.R_plus, Made::of_environment);
  add_value(e, a, "R-", r.R_minus, U.R_minus, Made::of_environment);
  add_value(e, a, "B", r.B, U.B, Made::of_environment);
  add_value(e, a, "B_mean", r.B_mean, U.B_mean, Made::of_environment);
}

/// One row per target. The U of a column applies to all targets: that of M to the means, and that
/// of R divided by 2 k to s.
PointTable table(const AxisAnalysis& a, const Iso230Result& r) {
  const Iso230Uncertainty U = iso230_2_uncertainty(a.budget.value_or(Budget{}), a.approaches, r.k);
  PointTable points;
  const auto column = [&](const char* name, Quantity quantity, double uncertainty, auto value_of) {
    PointTable::Column c{name, quantity, {}};
    for (const Iso230Point& p : r.points) c.values.push_back(static_cast<double>(value_of(p)));
    if (a.budget && std::isfinite(uncertainty)) c.U = uncertainty;
    points.columns.push_back(std::move(c));
  };
  using P = Iso230Point;
  column("target", a.position, NAN, [](const P& p) { return p.target; });
  column("mean+", a.deviation, U.M, [](const P& p) { return p.mean_plus; });
  column("mean-", a.deviation, U.M, [](const P& p) { return p.mean_minus; });
  column("mean", a.deviation, U.M, [](const P& p) { return p.mean; });
  column("B", a.deviation, U.B, [](const P& p) { return p.B; });
  column("s+", a.deviation, U.R_plus / (2.0 * r.k), [](const P& p) { return p.s_plus; });
  column("s-", a.deviation, U.R_minus / (2.0 * r.k), [](const P& p) { return p.s_minus; });
  column("R+", a.deviation, U.R_plus, [](const P& p) { return p.R_plus; });
  column("R-", a.deviation, U.R_minus, [](const P& p) { return p.R_minus; });
  column("R", a.deviation, U.R, [](const P& p) { return p.R; });
  column("n+", Quantity::count, NAN, [](const P& p) { return p.n_plus; });
  column("n-", Quantity::count, NAN, [](const P& p) { return p.n_minus; });
  return points;
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  NONIO_TRY(auto begun, begin_axis_analysis(in));
  const std::int64_t edition = in.options.integer("edition", 2014);
  const Iso230Result result = evaluate_iso230_2(begun.test, coverage_factor(edition));
  Evaluation e;
  add_values(e, begun, result);
  e.points = table(begun, result);
  e.findings = std::move(begun.findings);
  for (Finding& f : e.findings) f.measurement = in.measurement.id;
  e.notes.push_back({"method.iso230-2",
                     {{"edition", static_cast<double>(edition), Quantity::count},
                      {"k", result.k, Quantity::count},
                      {"two_k", 2.0 * result.k, Quantity::count}}});
  note_scatter(e, begun, "A, A+, A-, R, R+, R-");
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"iso230-2",
            "1.0.0",
            "Accuracy and repeatability of positioning according to ISO 230-2.",
            {one_of({"1988", "1997", "2006", "2014"},
                    {"edition", std::int64_t{2014}, "",
                     "Edition of the standard; 1988 has k = 3, the later ones k = 2."}),
             incomplete_targets_option()}};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::iso230_2
