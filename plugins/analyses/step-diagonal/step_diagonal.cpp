// SPDX-License-Identifier: Apache-2.0
// Sequential step diagonals: three positioning, six straightness and three squareness errors of a
// volume, as far as the readings determine them.
#include <algorithm>
#include <cmath>

#include "nonio/math/distributions.h"
#include "nonio/math/step_diagonals.h"
#include "nonio/sdk/plugin.h"
#include "nonio/sdk/results.h"
#include "passes.h"

namespace nonio::step_diagonal {

using namespace math;

namespace {

/// "PPP" of the pass "SD PPP", "PPP-run-2" of "SD PPP run 2".
std::string short_name(const std::string& pass) {
  const std::size_t run = pass.rfind(" run "), space = pass.find_last_of(' ', run - 1);
  std::string name = space == std::string::npos ? pass : pass.substr(space + 1);
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

PointTable table_of(const Passes& p) {
  const math::StepDiagonals& d = p.readings;
  PointTable table;
  table.columns.push_back({"target", Quantity::length, {}});
  for (std::size_t i = 0; i <= d.n; ++i)
    table.columns.back().values.push_back(d.diagonal() * static_cast<double>(i) /
                                          static_cast<double>(d.n));
  for (std::size_t k = 0; k < d.passes.size(); ++k) {
    table.columns.push_back({short_name(p.names[k]), Quantity::deviation, {0.0}});
    for (std::size_t i = 1; i <= d.n; ++i)
      table.columns.back().values.push_back(d.passes[k].reading[3 * i - 1]);
  }
  return table;
}

void put_whole_steps(const Passes& p, const math::StepSolution& s, const math::ReadingModel& model,
                     math::BudgetOf* budget, Evaluation& out) {
  PointTable table = table_of(p);
  double most = 0.0;
  std::size_t pass = 0, step = 0;
  bool whole = true;
  for (std::size_t k = 1; k < table.columns.size(); ++k)
    for (std::size_t i = 0; i <= p.readings.n; ++i) {
      const double v = table.columns[k].values[i];
      whole = whole && std::isfinite(v);
      if (std::fabs(v) > most) most = std::fabs(v), pass = k - 1, step = i;
    }
  if (budget != nullptr && step > 0) {
    std::vector<double> row(model.readings(), 0.0);
    const std::size_t zero = pass * (3 * p.readings.n + 1);
    row[zero + 3 * step] = 1.0;
    row[zero] = -1.0;
    out.values.push_back(budget->value("D_max", most, Quantity::deviation,
                                       std::sqrt(2.0) * s.u_reading, model.shares(row)));
  } else {
    out.values.push_back({"D_max", most, Quantity::deviation});
  }
  if (whole) out.points = std::move(table);
}

constexpr double level = 0.01;
constexpr double enough_dof = 15.0;  // with fewer, k = 2 does not cover 95 %
constexpr double urad = 1e-6, um = 1e-6, mm = 1e-3;

Number number(const char* name, double value, Quantity quantity) { return {name, value, quantity}; }

Finding attention(const char* id, std::vector<Number> evidence,
                  std::vector<std::pair<std::string, std::string>> texts = {}) {
  return {.id = id, .attention = true, .evidence = std::move(evidence), .texts = std::move(texts)};
}

/// Largest distance of a target from the beam, m. The mirror must be larger.
double lateral(const StepDiagonals& d) {
  double most = 0.0;
  for (std::size_t t = 1; t < 3; ++t) {
    const auto moves = d.counts(t);
    double square = 0.0, along = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double step = d.travel[k] / static_cast<double>(d.n) * static_cast<double>(moves[k]);
      square += step * step;
      along += step * d.travel[k] / d.diagonal();
    }
    most = std::max(most, std::sqrt(std::max(0.0, square - along * along)));
  }
  return most;
}

struct Work {
  const AnalysisInput& in;
  const Passes& passes;
  Lengths lengths;
  StepChoices choices;
  StepChecks checks;
  bool averaging = false;
  Evaluation out;
};

void judge_checks(Work& w) {
  const StepChecks& c = w.checks;
  if (math::significant(c.p_constant, level)) {
    const auto worst =
        *std::max_element(c.constant.begin(), c.constant.end(),
                          [](double a, double b) { return std::fabs(a) < std::fabs(b); });
    const bool stated = w.choices.set_up_known;
    Finding f = attention(stated ? "step-diagonal.set-up-not-square" : "step-diagonal.set-up-seen",
                          {number("constant", worst, Quantity::deviation),
                           number("u", c.u_reading, Quantity::deviation),
                           number("p", c.p_constant, Quantity::probability)});
    f.attention = stated;
    w.out.findings.push_back(std::move(f));
    w.choices.set_up_known = false;
  }
  if (math::significant(c.p_trend, level))
    w.out.findings.push_back(
        attention("step-diagonal.drift", {number("per_step", c.trend, Quantity::deviation),
                                          number("u", c.u_reading, Quantity::deviation),
                                          number("p", c.p_trend, Quantity::probability)}));
}

void judge_lengths(Work& w, const StepSolution& s) {
  for (const ShapeContrast& c : s.shapes)
    if (math::significant(c.p, level / 3.0))
      w.out.findings.push_back(
          attention("step-diagonal.axis-disagrees",
                    {number("rms", c.rms, Quantity::deviation),
                     number("largest", c.largest, Quantity::deviation),
                     number("at", c.at, Quantity::length), number("p", c.p, Quantity::probability)},
                    {{"axis", w.passes.axes[c.axis]}}));
  const auto gap = close_lengths(w.passes.readings, w.lengths.series, s.u_reading);
  if (gap && std::fabs(gap->value) > 3.0 * gap->u)
    w.out.findings.push_back(
        attention("step-diagonal.lengths-disagree", {number("gap", gap->value, Quantity::deviation),
                                                     number("u", gap->u, Quantity::deviation)}));
}

std::string open_scales(const StepSolution& s) {
  std::string open;
  for (const StepCurve& c : s.curves)
    if (!c.known) open += (open.empty() ? "" : ", ") + c.name;
  return open;
}

void say_scales(Work& w, const StepSolution& s) {
  const std::string open = open_scales(s);
  if (open.empty()) return;
  const double freedom = static_cast<double>(s.unknowns - s.rank);
  w.out.findings.push_back(attention("step-diagonal.scales-not-identified",
                                     {number("open", w.averaging ? 2.0 : freedom, Quantity::count)},
                                     {{"scales", open}}));
}

/// Whether the stated angular errors could cause a straightness above budget_um; adds a finding.
bool withheld(Work& w, const StepCurve& c) {
  const double angle = w.in.options.number("angle_urad") * urad;
  const double budget = w.in.options.number("budget_um") * um;
  const bool aliased = c.name == "EYX" || c.name == "EZX" || c.name == "EZY";
  const double size = w.passes.readings.travel[c.axis] / 2.0 * angle;
  if (!aliased || budget == 0.0 || !(size > budget)) return false;
  w.out.findings.push_back(attention(
      "step-diagonal.angles-too-large",
      {number("angle", angle, Quantity::small_angle), number("size", size, Quantity::deviation),
       number("budget", budget, Quantity::deviation)},
      {{"curve", c.name}}));
  return true;
}

void put_curve(Work& w, const StepCurve& c, const BudgetOf* budget) {
  Series s{c.known ? c.name : c.name + "_shape",
           w.passes.axes[c.axis],
           Quantity::length,
           Quantity::deviation,
           c.position,
           c.value,
           {}};
  if (budget != nullptr) budget->put(s, c.u, c.shares);
  w.out.series.push_back(std::move(s));
}

void put_values(Work& w, const StepSolution& s, const ReadingModel& model) {
  const bool stated = w.choices.u_reading > 0.0, certain = stated || s.dof >= enough_dof;
  if (!certain)
    w.out.findings.push_back(attention(
        "step-diagonal.no-uncertainty",
        {number("dof", s.dof, Quantity::count), number("wanted", enough_dof, Quantity::count)}));
  BudgetOf budget(model, s.u_reading, stated ? INFINITY : s.dof, Quantity::deviation,
                  stated ? "options.step-diagonal.u_reading_um" : "readings");
  static constexpr std::array<const char*, 3> names{"C0Y", "B0Z", "A0Z"}, axes{"XY", "XZ", "YZ"};
  for (std::size_t k = 0; k < 3; ++k) {
    const Estimated& v = s.squareness[k];
    if (certain)
      w.out.values.push_back(budget.value(names[k], v.value, Quantity::small_angle, v.u, v.shares));
    else
      w.out.values.push_back({names[k], v.value, Quantity::small_angle});
    w.out.values.back().followed = {std::string("squareness:") + axes[k], axes[k]};
  }
  for (const StepCurve& c : s.curves)
    if (!withheld(w, c)) put_curve(w, c, certain ? &budget : nullptr);
  put_whole_steps(w.passes, s, model, certain ? &budget : nullptr, w.out);
  if (certain && model.missing.empty()) w.out.budget = budget.budget();
}

/// The drift is increased to that of the check sums if this is significant.
HeldLimits limits_of(const Work& w) {
  HeldLimits held = limits_held(w.in.campaign, observations_of(w.in, w.lengths));
  auto& drift = held.environment.drift;
  const double n = static_cast<double>(w.passes.readings.n), seen = std::fabs(w.checks.trend) * n;
  if (w.checks.p_trend < level && drift && seen > *drift) {
    held.findings.push_back(attention(
        "uncertainty.limit-exceeded",
        {number("stated", *drift, Quantity::deviation), number("found", seen, Quantity::deviation)},
        {{"key", "environment.drift_um"}}));
    drift = seen;
  }
  return held;
}

void put_notes(Work& w, const StepSolution& s) {
  const auto n = static_cast<double>(w.passes.readings.n);
  double straightness = 0.0;
  for (const StepCurve& c : s.curves)
    if (c.name[1] != c.name[2])
      straightness = std::max(straightness, *std::max_element(c.u.begin(), c.u.end()));
  w.out.notes.push_back(
      {w.averaging ? "method.step-averaging" : "method.step-least-squares",
       {number("n", n, Quantity::count), number("u", s.u_reading, Quantity::deviation),
        number("dof", s.dof, Quantity::count)}});
  if (s.u_reading > 0.0)
    w.out.notes.push_back(
        {"step-diagonal.random-walk",
         {number("n", n, Quantity::count), number("u", s.u_reading, Quantity::deviation),
          number("most", straightness, Quantity::deviation),
          number("gain", straightness / s.u_reading, Quantity::ratio)}});
  if (!s.set_up.empty())
    w.out.notes.push_back({"step-diagonal.set-up",
                           {number("angle", *std::max_element(s.set_up.begin(), s.set_up.end()),
                                   Quantity::small_angle)}});
  w.out.notes.push_back({"step-diagonal.angles-not-identifiable"});
}

bool refuse_mirror(Work& w) {
  const double mirror = w.in.options.number("mirror_mm") * mm, way = lateral(w.passes.readings);
  if (mirror == 0.0 || !(way > mirror)) return false;
  w.out.findings.push_back(attention(
      "step-diagonal.mirror",
      {number("way", way, Quantity::length), number("mirror", mirror, Quantity::length)}));
  return true;
}

Evaluation finished(Work& w) {
  for (Finding& f : w.out.findings) f.measurement = w.in.measurement.id;
  for (Remark& r : w.out.notes) r.measurement = w.in.measurement.id;
  return std::move(w.out);
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  NONIO_TRY(const auto passes, passes_of(in));
  Work w{in, passes, {}, {}, {}, in.options.text("method") == "averaging", {}};
  w.out.findings = passes.refusal;
  if (!passes.refusal.empty() || refuse_mirror(w)) return finished(w);
  w.lengths = w.averaging ? Lengths{} : lengths_of(in, passes);
  w.out.uses = w.lengths.ids;
  for (const Finding& f : w.lengths.findings) w.out.findings.push_back(f);
  w.choices = {in.options.flag("set_up_square"), in.options.text("beam") == "off-diagonal",
               in.options.number("u_reading_um") * um};
  w.checks = check_step_diagonals(passes.readings);
  judge_checks(w);
  const HeldLimits limits = limits_of(w);
  ReadingModel model =
      reading_model(in.campaign, limits.environment, budget_lines(passes, w.lengths, in.campaign));
  if (const double angle = in.options.number("angle_urad"); angle > 0.0)
    model.inputs.push_back(angles_input(passes, model, angle * urad));
  const auto solution =
      w.averaging ? average_step_diagonals(passes.readings, w.choices, &model)
                  : solve_step_diagonals(passes.readings, w.lengths.series, w.choices, &model);
  if (!solution) {
    w.out.findings.push_back(attention(
        "step-diagonal.incomplete",
        {number("missing", static_cast<double>(in.observations.missing), Quantity::count)}));
    return finished(w);
  }
  if (!w.averaging) judge_lengths(w, *solution);
  say_scales(w, *solution);
  w.out.findings.insert(w.out.findings.end(), limits.findings.begin(), limits.findings.end());
  if (!model.missing.empty()) w.out.findings.push_back(missing_finding(model.missing));
  put_values(w, *solution, model);
  put_notes(w, *solution);
  return finished(w);
}

std::vector<Option> options() {
  return {
      one_of(
          {"least-squares", "averaging"},
          {"method", std::string("least-squares"), "",
           "Least squares with the set-up angles, or the conventional averaging of increments."}),
      at_least(0.0, {"u_reading_um", 0.0, "um",
                     "Standard uncertainty of a reading; 0: from the residuals."}),
      {"set_up_square", false, "",
       "The mirror is known to be square to the diagonals within the noise over a step."},
      one_of({"off-diagonal", "on-diagonal"},
             {"beam", std::string("off-diagonal"), "",
              "Where a set-up angle comes from: the mirror is square to a beam off the diagonal, "
              "or only the mirror is tilted."}),
      {"lengths", std::vector<std::string>{}, "",
       "Ids of the axis measurements that give the lengths; none: those with the same words after "
       "the name (SD final: X final)."},
      at_least(0.0, {"mirror_mm", 0.0, "mm", "Usable half width of the mirror; 0: not checked."}),
      at_least(0.0, {"angle_urad", 0.0, "urad", "Largest yaw or pitch of an axis; 0: not known."}),
      at_least(0.0,
               {"budget_um", 0.0, "um",
                "Straightness is withheld where angle_urad could make more than this; 0: never."})};
}

bool applies(const Campaign&, const Measurement& m) { return m.kind == "step-diagonal"; }

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"step-diagonal", "1.0.0",
            "Positioning, straightness and squareness of a volume from four step diagonals.",
            options()};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::step_diagonal
