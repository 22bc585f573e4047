// SPDX-License-Identifier: Apache-2.0
// ISO 230-6: positioning along body and face diagonals.
#include <algorithm>
#include <cmath>

#include "nonio/math/along.h"
#include "nonio/math/axis_analysis.h"
#include "nonio/math/blindness.h"
#include "nonio/math/iso230_2.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/plugin.h"

namespace nonio::iso230_6 {

using namespace math;

namespace {

constexpr double k_of_2002 = 2.0;
constexpr double same_end = 1e-4;           // m
constexpr std::size_t approaches_of_R = 5;  // R and A of ISO 230-2 require five approaches

bool applies(const Campaign&, const Measurement& m) {
  const std::size_t moving = moving_axes(m).size();
  return m.kind == "diagonal" && (moving == 2 || moving == 3);
}

struct Diagonal {
  std::size_t measurement = 0;
  std::string name;  ///< PPP, NPP, PNP, PPN; PP, PN of a face
  std::vector<std::string> axes;
};

Diagonal diagonal_of(const Campaign& campaign, std::size_t i) {
  const Measurement& m = campaign.measurements[i];
  Diagonal d{i, {}, moving_axes(m)};
  std::size_t negative = 0;
  for (const std::string& axis : d.axes) negative += m.to.at(axis) < m.from.at(axis);
  const bool other_end =
      2 * negative > d.axes.size() ||
      (2 * negative == d.axes.size() && m.to.at(d.axes[0]) < m.from.at(d.axes[0]));
  for (const std::string& axis : d.axes)
    d.name += (m.to.at(axis) < m.from.at(axis)) != other_end ? 'N' : 'P';
  return d;
}

bool same_box(const Measurement& a, const Measurement& b, const std::string& axis) {
  const auto x = std::minmax(a.from.at(axis), a.to.at(axis)),
             y = std::minmax(b.from.at(axis), b.to.at(axis));
  return std::fabs(x.first - y.first) <= same_end && std::fabs(x.second - y.second) <= same_end;
}

std::vector<Diagonal> set_of(const Campaign& campaign, const Measurement& of) {
  std::vector<Diagonal> out;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (!applies(campaign, m) || state_of(m) != state_of(of)) continue;
    const bool fits = m.from.size() == of.from.size() &&
                      std::all_of(of.from.begin(), of.from.end(), [&](const auto& end) {
                        return m.from.contains(end.first) && m.to.contains(end.first) &&
                               of.to.contains(end.first) && same_box(m, of, end.first);
                      });
    if (fits) out.push_back(diagonal_of(campaign, i));
  }
  return out;
}

struct Tested {
  AxisTest test;
  Iso230Result result{};
  BudgetOrGap budget;
  Iso230Uncertainty U{};
  std::size_t approaches = 0;
  std::vector<Finding> findings;
};

std::optional<Tested> tested(const AnalysisInput& in, std::size_t i) {
  const Measurement& m = in.campaign.measurements[i];
  const Observations& o = (*in.all)[i];
  Tested out;
  const Observations line = along_diagonal(o, m);
  if (line.axes.front().approach.size() != o.size() || o.size() == 0) return std::nullopt;
  out.test = AxisTest::arrange(line);
  if (out.test.targets.size() < 2) return std::nullopt;
  out.result = evaluate_iso230_2(out.test, k_of_2002);
  out.approaches = approaches_per_mean(out.test);
  const Observations* own = &o;
  HeldLimits limits = limits_held(in.campaign, {&own, 1});
  out.budget = budget_along(in.campaign, limits.environment, m, out.test);
  out.U = iso230_2_uncertainty(out.budget.budget.value_or(Budget{}), out.approaches, k_of_2002);
  out.findings = std::move(limits.findings);
  require_repetition(out.test, out.budget.budget, "R, R+, R-, A", out.findings);
  return out;
}

void put_values(Evaluation& e, const AxisAnalysis& a, const Tested& t) {
  const Iso230Result& r = t.result;
  add_value(e, a, "E", r.E, t.U.E, Made::of_all);
  add_value(e, a, "E+", r.E_plus, t.U.E_plus, Made::of_all);
  add_value(e, a, "E-", r.E_minus, t.U.E_minus, Made::of_all);
  add_value(e, a, "B", r.B, t.U.B, Made::of_environment);
  if (t.approaches < approaches_of_R) return;
  add_value(e, a, "R", r.R, t.U.R, Made::of_environment);
  add_value(e, a, "R+", r.R_plus, t.U.R_plus, Made::of_environment);
  add_value(e, a, "R-", r.R_minus, t.U.R_minus, Made::of_environment);
  add_value(e, a, "A", r.A, t.U.A, Made::of_all);
}

PointTable table(const Iso230Result& r) {
  PointTable::Column target{"target", Quantity::length, {}}, plus{"mean+", Quantity::deviation, {}},
      minus{"mean-", Quantity::deviation, {}}, B{"B", Quantity::deviation, {}};
  for (const Iso230Point& p : r.points) {
    target.values.push_back(p.target);
    plus.values.push_back(p.mean_plus);
    minus.values.push_back(p.mean_minus);
    B.values.push_back(p.B);
  }
  return {{std::move(target), std::move(plus), std::move(minus), std::move(B)}};
}

std::string joined(const std::vector<std::string>& parts, const char* between) {
  std::string out;
  for (const std::string& p : parts) out += (out.empty() ? "" : between) + p;
  return out;
}

/// Corners in machine coordinates, m. The third coordinate of a face diagonal is 0.
std::vector<ThroughVolume> paths(const Campaign& campaign, const std::vector<Diagonal>& set) {
  std::vector<ThroughVolume> out;
  for (const Diagonal& d : set) {
    const Measurement& m = campaign.measurements[d.measurement];
    ThroughVolume& line = out.emplace_back();
    for (const std::string& axis : d.axes)
      if (const std::size_t k = coordinate_of(axis); k < 3)
        line.from[k] = m.from.at(axis), line.to[k] = m.to.at(axis);
  }
  return out;
}

/// Error combinations that the diagonals cannot detect, such as "EYY 1, EXX -0.56".
Finding blind_finding(const Campaign& campaign, const std::vector<Diagonal>& set) {
  const Blindness b = blind_to(paths(campaign, set));
  std::vector<std::string> combinations;
  for (const auto& terms : b.combinations) {
    std::vector<std::string> one;
    for (const auto& [name, size] : terms) one.push_back(name + " " + fixed_text(size, 2));
    combinations.push_back(joined(one, ", "));
  }
  return {.id = "iso230-6.blind",
          .evidence = {{"errors", static_cast<double>(b.errors), Quantity::count},
                       {"told", static_cast<double>(b.rank), Quantity::count}},
          .texts = {{"unseen", b.unseen.empty() ? "-" : joined(b.unseen, ", ")},
                    {"combinations", joined(combinations, "; ")}}};
}

std::vector<std::string> missing_of(const std::vector<Diagonal>& set) {
  std::vector<std::string> names{"PP", "PN"}, out;
  if (set.front().axes.size() == 3) names = {"PPP", "NPP", "PNP", "PPN"};
  for (const std::string& name : names)
    if (std::none_of(set.begin(), set.end(), [&](const Diagonal& d) { return d.name == name; }))
      out.push_back(name);
  return out;
}

void put_machine(const AnalysisInput& in, const AxisAnalysis& a, const std::vector<Diagonal>& set,
                 Evaluation& e) {
  struct Largest {
    double value = -1.0;
    ResultUncertainty U;
    std::string of;
  } E, B;
  std::vector<std::string> measured;
  std::size_t counted = 0;
  for (const Diagonal& d : set) {
    const auto t = tested(in, d.measurement);
    if (!t) continue;
    ++counted;
    measured.push_back(d.name);
    const Iso230Uncertainty U = t->budget.budget ? t->U : Iso230Uncertainty{};
    if (t->result.E > E.value) E = {t->result.E, U.E, d.name};
    if (t->result.B > B.value) B = {t->result.B, U.B, d.name};
  }
  if (E.value >= 0.0) add_value(e, a, "E_d", E.value, E.U, Made::of_all);
  if (B.value >= 0.0) add_value(e, a, "B_d", B.value, B.U, Made::of_environment);
  const auto missing = missing_of(set);
  if (!missing.empty())
    e.findings.push_back(
        {.id = "iso230-6.fewer",
         .attention = true,
         .evidence = {{"measured", static_cast<double>(counted), Quantity::count},
                      {"wanted", set.front().axes.size() == 3 ? 4.0 : 2.0, Quantity::count}},
         .texts = {{"which", joined(measured, ", ")}, {"missing", joined(missing, ", ")}}});
  if (E.value < 0.0)
    e.findings.push_back({.id = "iso230-6.one-direction", .attention = true});
  else
    e.findings.push_back(
        {.id = "iso230-6.largest",
         .evidence = {{"E_d", E.value, Quantity::deviation}, {"B_d", B.value, Quantity::deviation}},
         .texts = {{"of_E", E.of}, {"of_B", B.of}}});
  e.findings.push_back(blind_finding(in.campaign, set));
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  if (in.all == nullptr) return fail("expected the other measurements of the campaign, found none");
  const std::vector<Diagonal> set = set_of(in.campaign, in.measurement);
  const auto own = std::find_if(set.begin(), set.end(), [&](const Diagonal& d) {
    return in.campaign.measurements[d.measurement].id == in.measurement.id;
  });
  const auto t = tested(in, own->measurement);
  Evaluation e;
  if (!t) {
    e.findings.push_back({.id = "iso230-6.no-directions", .attention = true});
    return e;
  }
  AxisAnalysis a;
  a.axis = "*";  // for budget messages: all axes expand along a diagonal
  a.test = t->test;
  a.budget = t->budget.budget;
  a.approaches = t->approaches;
  e.findings = t->findings;
  if (!t->budget.missing.empty()) e.findings.push_back(missing_finding(t->budget.missing));
  put_values(e, a, *t);
  e.points = table(t->result);
  if (own == set.begin()) {
    for (const Diagonal& d : set)
      if (d.measurement != own->measurement)
        e.uses.push_back(in.campaign.measurements[d.measurement].id);
    put_machine(in, a, set, e);
  }
  e.notes.push_back(
      {"method.iso230-6",
       {{"edition", static_cast<double>(in.options.integer("edition", 2002)), Quantity::count},
        {"k", k_of_2002, Quantity::count}},
       {{"name", own->name}}});
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"iso230-6",
            "1.0.0",
            "Positioning along body and face diagonals according to ISO 230-6.",
            {one_of({"2002"}, {"edition", std::int64_t{2002}, "",
                               "Edition of the standard whose terms are used."})}};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::iso230_6
