// SPDX-License-Identifier: Apache-2.0
// Errors of the rotary axis parameters of a control, from readings with active tool center point
// control.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>

#include "check.h"
#include "nonio/math/distributions.h"

namespace nonio::rtcp {
namespace {

constexpr double level = 0.01;
constexpr double per_um = 1e-6, per_urad = 1e-6;

bool applies(const Campaign&, const Measurement& m) { return m.kind == "rtcp"; }

Wish wish_of(const Settings& options, const std::string& axis) {
  Wish wish;
  const auto names = [&](const char* option) {
    const auto all = options.texts(option);
    return std::find(all.begin(), all.end(), axis) != all.end();
  };
  if (names("tables") != names("heads")) wish.head = names("heads");
  if (const double s = options.number("sigma_um"); s > 0.0) wish.sigma = s * per_um;
  if (const double c = options.number("linear_axes_urad"); c > 0.0) wish.linear_axes = c * per_urad;
  if (const double b = options.number("ball_um"); b > 0.0) wish.U_ball = b * per_um;
  wish.tolerance = options.number("tolerance_um") * per_um;
  wish.tolerance_direction = options.number("tolerance_urad") * per_urad;
  return wish;
}

Quantity quantity_of(std::size_t value) {
  return value < 2 ? Quantity::deviation : Quantity::small_angle;
}

void add_values(const Checked& c, math::BudgetOf& budget, Evaluation& out) {
  for (std::size_t k = 0; k < 4; ++k)
    if (c.is_identifiable(k))
      out.values.push_back(budget.value(c.names[k], c.fit.value[k], quantity_of(k),
                                        c.u_repetition(k), c.model.shares(c.fit.by[k])));
}

/// Largest range of a line, as seen on a gauge. It has no U because it uses raw readings.
void add_span(const Checked& c, Evaluation& out) {
  double span = 0.0;
  std::vector<double> low, high;
  for (const auto& r : c.readings) {
    if (r.line >= low.size()) low.resize(r.line + 1, INFINITY), high.resize(r.line + 1, -INFINITY);
    low[r.line] = std::min(low[r.line], r.deviation);
    high[r.line] = std::max(high[r.line], r.deviation);
  }
  for (std::size_t l = 0; l < low.size(); ++l)
    if (low[l] <= high[l]) span = std::max(span, high[l] - low[l]);
  out.values.push_back({"span", span, Quantity::deviation});
  // Scatter that new parameters can reduce: readings about the mean of their line, and fit
  // residuals.
  std::vector<double> sum(low.size(), 0.0), n(low.size(), 0.0);
  for (const auto& r : c.readings) sum[r.line] += r.deviation, n[r.line] += 1.0;
  double measured = 0.0, optimised = 0.0;
  for (std::size_t i = 0; i < c.readings.size(); ++i) {
    const auto& r = c.readings[i];
    measured += std::pow(r.deviation - sum[r.line] / n[r.line], 2);
    optimised += std::pow(c.fit.residual[i], 2);
  }
  const auto count = static_cast<double>(c.readings.size());
  out.values.push_back({"scatter_measured", std::sqrt(measured / count), Quantity::deviation});
  out.values.push_back({"scatter_optimised", std::sqrt(optimised / count), Quantity::deviation});
  if (c.fit.dof > 0) out.values.push_back({"s", c.fit.s, Quantity::deviation});
}

void add_curves(const Checked& c, const Observations& o, Evaluation& out) {
  std::vector<double> angle, line, deviation, left;
  for (std::size_t i = 0; i < c.readings.size(); ++i) {
    angle.push_back(c.readings[i].angle);
    line.push_back(static_cast<double>(c.readings[i].line) + 1.0);
    deviation.push_back(c.readings[i].deviation);
    left.push_back(c.fit.residual[i]);
  }
  out.points.columns = {{"target", Quantity::angle, angle},
                        {"line", Quantity::count, line},
                        {"deviation", Quantity::deviation, deviation},
                        {"residual", Quantity::deviation, left}};
  for (std::size_t l = 0; l < o.lines.size(); ++l) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < c.readings.size(); ++i)
      if (c.readings[i].line == l) order.emplace_back(c.readings[i].angle, i);
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    Series s{"line_" + std::to_string(l + 1),
             o.axes.front().axis,
             Quantity::angle,
             Quantity::deviation,
             {},
             {},
             {}};
    std::vector<double> n;
    for (const auto& [at, i] : order) {
      if (!s.position.empty() && std::fabs(s.position.back() - at) < 1e-6) {
        n.back() += 1.0;
        s.value.back() += (deviation[i] - s.value.back()) / n.back();
        continue;
      }
      s.position.push_back(at);
      s.value.push_back(deviation[i]);
      n.push_back(1.0);
    }
    if (s.position.size() > 1) out.series.push_back(std::move(s));
  }
}

/// Reports values above three standard uncertainties. With this limit, 1 % of campaigns with four
/// correct values report one.
void tell_left(const Checked& c, Evaluation& out) {
  std::string names;
  bool any = false;
  for (const Value& v : out.values) {
    if (!v.U) continue;
    any = true;
    if (std::fabs(v.value) > 3.0 / v.k * *v.U) names += (names.empty() ? "" : ", ") + v.name;
  }
  if (!any) return;
  out.findings.push_back({.id = names.empty() ? "rtcp.nothing-left" : "rtcp.left",
                          .attention = !names.empty(),
                          .evidence = {{"x", c.fit.point[0], Quantity::length},
                                       {"y", c.fit.point[1], Quantity::length},
                                       {"z", c.fit.point[2], Quantity::length}},
                          .texts = {{"names", names}}});
}

std::optional<std::size_t> before_of(const Campaign& campaign, const Measurement& after) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.adjustment != "before" || m.kind != after.kind || m.axis != after.axis) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

/// Chi-square test of the factor f in after = f before: 0 if the new parameters compensate, 1 if
/// they are not active, 2 if their sign is wrong. The new parameters are from `one`.
void compare(const Checked& one, const Checked& two, const std::string& before, Evaluation& out) {
  const auto u_one = whole_u(one), u_two = whole_u(two);
  double n = 0.0, p[3] = {1.0, 1.0, 1.0}, top = 0.0, bottom = 0.0;
  for (int f = 0; f < 3; ++f) {
    double chi = 0.0;
    n = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!one.is_identifiable(k) || !two.is_identifiable(k) || one.names[k] != two.names[k])
        continue;
      const double share = f == 0 ? 1.0 : f, u = std::hypot(share * u_one[k], u_two[k]),
                   left = two.fit.value[k] - f * one.fit.value[k];
      if (!(u > 0.0)) continue;
      chi += left * left / (u * u);
      n += 1.0;
      if (f == 1) {
        top += one.fit.value[k] * two.fit.value[k] / (u * u);
        bottom += one.fit.value[k] * one.fit.value[k] / (u * u);
      }
    }
    if (n > 0.0) p[f] = math::f_upper(chi / n, n, 1e9);
  }
  if (n == 0.0) return;
  int fits = 0, which = 0;
  for (int f = 0; f < 3; ++f)
    if (p[f] >= level) ++fits, which = f;
  static constexpr const char* answers[] = {"rtcp.worked", "rtcp.not-active", "rtcp.wrong-sign"};
  const char* id = fits == 0   ? "rtcp.something-else"
                   : fits == 1 ? answers[which]
                               : "rtcp.cannot-tell";
  out.findings.push_back(
      {.id = id,
       .attention = !(fits == 1 && which == 0),
       .evidence = {{"share", bottom > 0.0 ? top / bottom : 0.0, Quantity::ratio},
                    {"p_worked", p[0], Quantity::probability},
                    {"p_not_active", p[1], Quantity::probability},
                    {"p_wrong_sign", p[2], Quantity::probability}},
       .texts = {{"before", before}}});
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  const Measurement& m = in.measurement;
  const Wish wish = wish_of(in.options, m.axis);
  const std::array<const Observations*, 1> own{&in.observations};
  const math::HeldLimits limits = math::limits_held(in.campaign, own);
  Checked c = check(in.campaign, in.observations, m.axis, limits.environment, wish);
  Evaluation out;
  out.findings = std::move(c.findings);
  if (!c.given) return out;
  out.findings.insert(out.findings.end(), limits.findings.begin(), limits.findings.end());
  if (!c.model.missing.empty()) out.findings.push_back(math::missing_finding(c.model.missing));
  math::BudgetOf budget(c.model, c.sigma, c.dof, Quantity::deviation,
                        std::isfinite(c.dof) ? "readings" : "options.rtcp.sigma_um");
  add_values(c, budget, out);
  tell_left(c, out);
  add_span(c, out);
  add_curves(c, in.observations, out);
  if (c.model.missing.empty()) out.budget = budget.budget();
  if (const auto before = before_of(in.campaign, m);
      m.adjustment == "after" && before && in.all != nullptr && (*in.all)[*before].size() > 0) {
    const Checked first = check(in.campaign, (*in.all)[*before], m.axis, limits.environment, wish);
    if (first.given) {
      out.uses.push_back(in.campaign.measurements[*before].id);
      compare(first, c, in.campaign.measurements[*before].id, out);
    }
  }
  out.notes.push_back({std::isfinite(c.dof) ? "method.rtcp-residuals" : "method.rtcp-sigma",
                       {{"sigma", c.sigma, Quantity::deviation},
                        {"dof", static_cast<double>(c.fit.dof), Quantity::count},
                        {"x", c.fit.point[0], Quantity::length},
                        {"y", c.fit.point[1], Quantity::length},
                        {"z", c.fit.point[2], Quantity::length}},
                       {{"axis", m.axis}}});
  out.notes.push_back({*wish.head ? "rtcp.of-head" : "rtcp.of-table", {}, {{"axis", m.axis}}});
  return out;
}

std::vector<Option> options() {
  return {
      {"tables", std::vector<std::string>{}, "",
       "Rotary axes that carry the workpiece; each measured axis is named here or in heads."},
      {"heads", std::vector<std::string>{}, "", "Rotary axes that carry the tool."},
      within(0.0, 1e4,
             {"sigma_um", 0.0, "um", "Standard uncertainty of a reading; 0: from the residuals."}),
      within(0.0, 1e4,
             {"linear_axes_urad", 0.0, "urad",
              "Bound of squareness and scale difference of the linear axes; 0: not known."}),
      within(0.0, 1e4,
             {"ball_um", 0.0, "um",
              "U (k = 2) of the ball's place against the one in the control; 0: not known."}),
      within(1e-3, 1e6,
             {"tolerance_um", 50.0, "um",
              "Wanted U of the centre; a value that misses it is not given."}),
      within(1e-3, 1e6,
             {"tolerance_urad", 500.0, "urad",
              "Wanted U of the direction; a value that misses it is not given."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"rtcp", "1.0.0",
            "What is wrong in the control's rotary axis, with its tool centre point control on.",
            options()};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::rtcp
