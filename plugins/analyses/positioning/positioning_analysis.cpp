// SPDX-License-Identifier: Apache-2.0
// Positioning of an axis by several rules (standards) at once from one set of statistics.
// engine/math/axis/positioning.cpp defines the rules.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "nonio/math/axis_analysis.h"
#include "nonio/math/positioning.h"
#include "nonio/sdk/plugin.h"
#include "nonio/sdk/results.h"

namespace nonio::positioning {

using namespace math;

namespace {

using Rules = std::vector<const math::PositioningRule*>;

/// The constant that a rule without offset subtracts from the deviations.
struct TakenOff {
  double value = 0.0;  ///< m or rad
  Quantity quantity = Quantity::deviation;
  std::string option;
};

using math::Confidence;
using math::PositioningRule;
using math::RuleForm;

template <class Wanted>
Rules those(const Rules& rules, const Wanted& wanted) {
  Rules out;
  std::copy_if(rules.begin(), rules.end(), std::back_inserter(out),
               [&](const PositioningRule* r) { return wanted(*r); });
  return out;
}

Rules of_form(const Rules& rules, RuleForm form) {
  return those(rules, [&](const PositioningRule& r) { return r.form == form; });
}

std::string titles(const Rules& rules) {
  std::string out;
  for (const PositioningRule* r : rules) out += (out.empty() ? "" : ", ") + std::string(r->title);
  return out;
}

class Remarks {
 public:
  void say(const char* id, const Rules& of, std::vector<Number> evidence = {}) {
    if (!of.empty()) out_.push_back({id, std::move(evidence), {{"rules", titles(of)}}, {}, {}});
  }
  void say_if(bool so, const char* id) {
    if (so) out_.push_back({id, {}, {}, {}, {}});
  }
  std::vector<Remark> take() { return std::move(out_); }

 private:
  std::vector<Remark> out_;
};

Remark evaluated(const Rules& rules) {
  Remark out{"rules.evaluated", {}, {{"rules", titles(rules)}}, {}, {}};
  for (const PositioningRule* r : rules) out.texts.emplace_back(r->name, r->title);
  return out;
}

std::vector<Remark> remarks_on(const Rules& rules, const TakenOff& off, bool with_U) {
  Remarks remarks;
  for (const double k : {2.0, 3.0})
    remarks.say(
        "rules.k",
        those(rules, [&](const PositioningRule& r) { return r.form == RuleForm::iso && r.k == k; }),
        {{"k", k, Quantity::count}, {"two_k", 2.0 * k, Quantity::count}});
  remarks.say("rules.upr", of_form(rules, RuleForm::upr));
  remarks.say("rules.vdi", of_form(rules, RuleForm::vdi));
  remarks.say("rules.raw", of_form(rules, RuleForm::raw));
  remarks.say("rules.nmtba", of_form(rules, RuleForm::nmtba));
  remarks.say("rules.jis", of_form(rules, RuleForm::jis));
  std::vector<Remark> out = {evaluated(rules)};
  for (Remark& r : remarks.take()) out.push_back(std::move(r));

  const Rules without = those(rules, [](const PositioningRule& r) { return r.without_offset; });
  if (!without.empty() && std::isfinite(off.value))
    out.push_back({"rules.offset",
                   {{"offset", off.value, off.quantity}},
                   {{"rules", titles(without)}, {"how", off.option}},
                   {},
                   {}});

  const auto with_k = [&](double k) {
    return std::any_of(rules.begin(), rules.end(), [&](const PositioningRule* r) {
      return r->form == RuleForm::iso && r->k == k;
    });
  };
  const bool iso = with_k(2.0) || with_k(3.0), vdi = !of_form(rules, RuleForm::vdi).empty(),
             raw = !of_form(rules, RuleForm::raw).empty(),
             nmtba = !of_form(rules, RuleForm::nmtba).empty(),
             jis = !of_form(rules, RuleForm::jis).empty();
  remarks.say_if(with_k(2.0) && with_k(3.0), "rules.differ-k");
  remarks.say_if(vdi && iso, "rules.differ-vdi");
  remarks.say_if(raw && (iso || vdi || nmtba), "rules.differ-raw");
  remarks.say_if((nmtba || jis) && (iso || vdi || raw), "rules.differ-plus-minus");
  remarks.say_if(jis && (iso || vdi || nmtba || raw), "rules.differ-one-pass");
  remarks.say("rules.known", those(rules, [](const PositioningRule& r) {
                return r.confidence == Confidence::known;
              }));
  remarks.say("rules.inferred", those(rules, [](const PositioningRule& r) {
                return r.confidence == Confidence::inferred;
              }));
  remarks.say_if(vdi, "rules.value-inferred");
  remarks.say_if(with_U, "rules.uncertainty");
  for (Remark& r : remarks.take()) out.push_back(std::move(r));
  return out;
}

bool applies(const Campaign&, const Measurement& m) { return m.kind == "axis"; }

std::string names_of_rules() {
  std::string out;
  for (const PositioningRule& r : positioning_rules())
    out += (out.empty() ? "" : ", ") + std::string(r.name);
  return out;
}

Expected<Rules> asked_rules(const Settings& options) {
  Rules out;
  const auto refuse = [](std::string message) {
    Error error{std::move(message)};
    error.key = "rules";
    return fail(std::move(error));
  };
  for (const std::string& name : options.texts("rules")) {
    const PositioningRule* rule = positioning_rule(name);
    if (rule == nullptr)
      return refuse("rules: expected some of " + names_of_rules() + "; found \"" + name + "\"");
    if (std::find(out.begin(), out.end(), rule) != out.end())
      return refuse("rules: \"" + name + "\" is given twice");
    out.push_back(rule);
  }
  if (out.empty()) return refuse("rules: expected at least one of " + names_of_rules());
  return out;
}

constexpr std::pair<const char*, Offset> offsets[] = {{"mean-of-all", Offset::mean_of_all},
                                                      {"first-target", Offset::first_target},
                                                      {"mid-range", Offset::mid_range}};

Offset offset_option(const Settings& options) {
  for (const auto& [name, offset] : offsets)
    if (options.text("nmtba_offset") == name) return offset;
  return Offset::mean_of_all;
}

std::string add_values(Evaluation& e, const AxisAnalysis& a, const AxisStatistics& statistics,
                       const Rules& rules, Offset offset) {
  std::string absent;
  for (const PositioningRule* rule : rules)
    for (const RuleValue& v : evaluate_rule(*rule, statistics, offset)) {
      std::string name = std::string(rule->name) + ":" + std::string(v.name);
      if (!std::isfinite(v.value)) absent += (absent.empty() ? "" : ", ") + name;
      const ResultUncertainty U =
          rule_uncertainty(a.budget.value_or(Budget{}), a.approaches, v.share);
      add_value(e, a, std::move(name), v.value, U,
                v.share.systematic ? Made::of_all : Made::of_environment);
    }
  return absent;
}

void add_slopes(Evaluation& e, const AxisAnalysis& a, const AxisStatistics& statistics) {
  const Slopes slopes = slopes_of(statistics);
  for (const auto& [name, value] :
       {std::pair("slope", slopes.least_squares), {"slope_ends", slopes.end_points}}) {
    if (!std::isfinite(value)) continue;
    Value v{name, value, slope_of(a.test.rotary)};
    if (a.budget && e.budget) {
      const Budget of_slope = slope_budget(*a.budget);
      const ResultUncertainty U = slope_uncertainty(of_slope, a.approaches);
      v.U = U.U;
      std::vector<double> parts =
          shares_of(of_slope, {U.U * a.budget->length, U.of_readings * a.budget->length}, true);
      for (double& part : parts) part /= a.budget->length;
      e.budget->results.push_back({v.name, v.quantity, std::move(parts), 2.0, INFINITY});
    }
    e.values.push_back(std::move(v));
  }
}

PointTable table(const AxisAnalysis& a, const AxisStatistics& statistics) {
  const Budget b = a.budget.value_or(Budget{});
  const auto U_of = [&](const RuleShare& share) {
    return rule_uncertainty(b, a.approaches, share);
  };
  PointTable points;
  const auto column = [&](const char* name, Quantity quantity, double U, auto value_of) {
    PointTable::Column c{name, quantity, {}};
    for (const auto& t : statistics.targets) c.values.push_back(static_cast<double>(value_of(t)));
    if (a.budget && std::isfinite(U)) c.U = U;
    points.columns.push_back(std::move(c));
  };
  using T = AxisStatistics::Target;
  const double of_mean = U_of({true, 1.0, 0.0, 0.0, &DriftShare::M}),
               of_B = U_of({false, 2.0, 0.0, 0.0, &DriftShare::B}),
               of_s = U_of({false, 0.0, 0.5, 0.0}), of_range = U_of({false, 0.0, 0.0, 1.0});
  column("target", a.position, NAN, [](const T& t) { return t.target; });
  column("mean+", a.deviation, of_mean, [](const T& t) { return t.plus.mean; });
  column("mean-", a.deviation, of_mean, [](const T& t) { return t.minus.mean; });
  column("mean", a.deviation, of_mean, [](const T& t) { return t.mean; });
  column("B", a.deviation, of_B, [](const T& t) { return t.B; });
  column("s+", a.deviation, of_s, [](const T& t) { return t.plus.s; });
  column("s-", a.deviation, of_s, [](const T& t) { return t.minus.s; });
  column("range+", a.deviation, of_range, [](const T& t) { return t.plus.high - t.plus.low; });
  column("range-", a.deviation, of_range, [](const T& t) { return t.minus.high - t.minus.low; });
  column("n+", Quantity::count, NAN, [](const T& t) { return t.plus.n; });
  column("n-", Quantity::count, NAN, [](const T& t) { return t.minus.n; });
  return points;
}

/// Replaces the names of absent ISO 230-2 values in the common findings by those of the rules.
void name_absent(std::vector<Finding>& findings, const std::string& absent) {
  for (Finding& f : findings)
    for (auto& [name, text] : f.texts)
      if (name == "absent") text = absent.empty() ? "–" : absent;
}

void plan(Evaluation& e, const AxisAnalysis& a, const Rules& rules) {
  for (const std::size_t asked : {5U, 7U}) {
    std::string titles;
    for (const PositioningRule* r : rules)
      if (r->approaches == asked && a.approaches < asked)
        titles += (titles.empty() ? "" : ", ") + std::string(r->title);
    if (!titles.empty())
      e.findings.push_back(
          {.id = "positioning.approaches",
           .evidence = {{"approaches", static_cast<double>(a.approaches), Quantity::count},
                        {"asked", static_cast<double>(asked), Quantity::count}},
           .texts = {{"rules", titles}}});
  }
}

void pass(Evaluation& e, const AxisStatistics& statistics, const Rules& rules) {
  std::string titles;
  for (const PositioningRule* r : rules)
    if (r->form == RuleForm::jis && std::isnan(evaluate_rule(*r, statistics).front().value))
      titles += (titles.empty() ? "" : ", ") + std::string(r->title);
  if (!titles.empty())
    e.findings.push_back({.id = "positioning.no-pass", .texts = {{"rules", titles}}});
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  NONIO_TRY(const auto rules, asked_rules(in.options));
  NONIO_TRY(auto begun, begin_axis_analysis(in));
  const AxisStatistics statistics = axis_statistics(begun.test);
  const Offset offset = offset_option(in.options);
  Evaluation e;
  const std::string absent = add_values(e, begun, statistics, rules, offset);
  add_slopes(e, begun, statistics);
  e.points = table(begun, statistics);
  e.findings = std::move(begun.findings);
  name_absent(e.findings, absent);
  plan(e, begun, rules);
  pass(e, statistics, rules);
  for (Finding& f : e.findings) f.measurement = in.measurement.id;
  e.notes = remarks_on(
      rules, {offset_of(statistics, offset), begun.deviation, in.options.text("nmtba_offset")},
      begun.budget.has_value());
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {
      "positioning",
      "1.0.0",
      "Positioning of an axis by any rule of the trade (ISO, VDI, ASME, NMTBA, BS, JIS, GB), "
      "several at once.",
      {{"rules", std::vector<std::string>{"iso-2014"}, "", "Any of " + names_of_rules() + "."},
       one_of({"mean-of-all", "first-target", "mid-range"},
              {"nmtba_offset", std::string("mean-of-all"), "",
               "What NMTBA without offset takes off: the mean of all bidirectional means, that of "
               "the first target, or the middle between the largest and the smallest. The rule "
               "does not state which."}),
       incomplete_targets_option()},
      true};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::positioning
