// SPDX-License-Identifier: Apache-2.0
// Errors of the rotary axis parameters of a control, from readings with active tool center point
// control.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "nonio/math/budget.h"
#include "nonio/math/distributions.h"
#include "nonio/math/rtcp.h"

namespace nonio::rtcp {

namespace {

/// Options of the user, in SI units; absent if not stated.
struct Wish {
  std::optional<bool> head;           ///< whether the axis carries the tool
  std::optional<double> sigma;        ///< standard uncertainty of a reading
  std::optional<double> linear_axes;  ///< bound of squareness and scale difference, rad
  std::optional<double> U_ball;       ///< U of each coordinate of the ball position, k = 2
  double tolerance = 0.0, tolerance_direction = 0.0;
};

/// Errors of the axis parameters of the control from one measurement, or why they are refused.
struct Checked {
  bool given = false;
  std::vector<math::RtcpReading> readings;  ///< sorted by line
  std::vector<std::size_t> row;             ///< row of each reading in the observations
  math::RtcpFit fit;
  double sigma = 0.0, dof = INFINITY;
  math::ReadingModel model;
  std::vector<Finding> findings;
  std::string names[4];  ///< of the values: centre_error_x, ..., direction_error_i

  double u_repetition(std::size_t value) const;
  /// Whether the readings determine the value with a U within the tolerance.
  bool is_identifiable(std::size_t value) const {
    return given && fit.identifiable[value] && wide[value] == 0.0;
  }
  double wide[4] = {0.0, 0.0, 0.0, 0.0};  ///< U if above the tolerance, otherwise 0
};

double Checked::u_repetition(std::size_t value) const {
  double square = 0.0;
  for (const double by : fit.by[value]) square += by * by;
  return sigma * std::sqrt(square);
}

constexpr double surely = 1e-3;  // significance level of residuals above the stated sigma

Finding finding(const char* id, std::vector<Number> evidence,
                std::vector<std::pair<std::string, std::string>> texts = {}) {
  return {.id = id, .attention = true, .evidence = std::move(evidence), .texts = std::move(texts)};
}

const char* name_of(math::RtcpRefusal refusal) {
  switch (refusal) {
    case math::RtcpRefusal::none_go_round:
      return "rtcp.none-go-round";
    case math::RtcpRefusal::not_a_circle:
      return "rtcp.not-a-circle";
    case math::RtcpRefusal::disagree:
      break;
  }
  return "rtcp.places-disagree";
}

/// Combined standard uncertainty of each value.
std::array<double, 4> whole_u(const Checked& c) {
  const math::BudgetOf budget(c.model, c.sigma, c.dof, Quantity::deviation);
  std::array<double, 4> out{};
  for (std::size_t k = 0; k < 4; ++k)
    if (c.fit.identifiable[k])
      out[k] = budget.expand(c.u_repetition(k), c.model.shares(c.fit.by[k])).u;
  return out;
}

class Check {
 public:
  Check(const Campaign& c, const Observations& o, std::string axis, const Environment& e,
        const Wish& wish)
      : campaign_(c), o_(o), axis_(std::move(axis)), environment_(e), wish_(wish) {}

  Checked done() {
    if (!wish_.head) {
      refuse(finding("rtcp.carries-needed", {}, {{"axis", axis_}}));
    } else if (columns() && fitted() && with_sigma()) {
      out_.given = true;
      name();
      budget();
      tell_wide();
      report_not_identifiable();
    }
    return std::move(out_);
  }

 private:
  bool refuse(Finding f) {
    out_.findings.push_back(std::move(f));
    return false;
  }

  bool columns() {
    const auto *x = o_.axis("X"), *y = o_.axis("Y"), *z = o_.axis("Z");
    if (o_.axes.empty() || !o_.axes.front().rotary || x == nullptr || y == nullptr || z == nullptr)
      return refuse(finding("rtcp.none-go-round", {{"lines", 0.0, Quantity::count}}));
    probe_ = std::all_of(o_.lines.begin(), o_.lines.end(), [](const auto& line) {
      return line.name.ends_with(" found x") || line.name.ends_with(" found y") ||
             line.name.ends_with(" found z");
    });
    // Sorted by line name and time, because the order of the rows has no meaning.
    std::vector<std::size_t> rank(o_.lines.size());
    for (const auto& line : o_.lines) names_.push_back(line.name);
    std::sort(names_.begin(), names_.end());
    for (std::size_t l = 0; l < rank.size(); ++l)
      rank[l] = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), o_.lines[l].name) -
                                         names_.begin());
    const std::vector<double> when = math::reading_times(o_);
    std::vector<std::size_t> order(o_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) {
      const std::size_t line = rank[o_.line_of(i)];
      return std::tuple(probe_ ? static_cast<std::size_t>(names_[line].back() - 'x') : line,
                        probe_ ? line : 0, when[i], o_.axes[0].position[i], o_.deviation[i]);
    };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    for (const std::size_t i : order) {
      if (!std::isfinite(o_.axes[0].position[i])) continue;
      out_.row.push_back(i);
      out_.readings.push_back({o_.axes[0].position[i],
                               {x->position[i], y->position[i], z->position[i]},
                               o_.sense_of(i),
                               o_.deviation[i],
                               rank[o_.line_of(i)],
                               probe_});
    }
    return true;
  }

  bool fitted() {
    auto fit = math::fit_rtcp(out_.readings, {*wish_.head, wish_.U_ball.has_value()});
    if (!fit)
      return refuse(finding(name_of(fit.error()),
                            {{"lines", static_cast<double>(o_.lines.size()), Quantity::count},
                             {"limit", math::rtcp_circle, Quantity::deviation}}));
    out_.fit = std::move(*fit);
    return true;
  }

  bool with_sigma() {
    const math::RtcpFit& fit = out_.fit;
    const auto dof = static_cast<double>(fit.dof);
    if (wish_.sigma) {
      const double ratio = fit.s / *wish_.sigma;
      if (fit.dof == 0 || !math::significant(math::f_upper(ratio * ratio, dof, 1e9), surely)) {
        out_.sigma = *wish_.sigma;
        return true;
      }
      out_.findings.push_back(finding(
          "rtcp.scatter",
          {{"s", fit.s, Quantity::deviation}, {"sigma", *wish_.sigma, Quantity::deviation}}));
    }
    if (fit.dof < 2)
      return refuse(finding(
          "rtcp.too-few", {{"readings", static_cast<double>(out_.readings.size()), Quantity::count},
                           {"dof", dof, Quantity::count}}));
    out_.sigma = fit.s;
    out_.dof = dof;
    return true;
  }

  void name() {
    for (std::size_t k = 0; k < 2; ++k) {
      out_.names[k] = std::string("centre_error_") + "xyz"[out_.fit.across[k]];
      out_.names[2 + k] = std::string("direction_error_") + "ijk"[out_.fit.across[k]];
    }
  }

  /// Squareness and scale errors (within +-bound) of the linear axes that follow the ball. They are
  /// zero at the axis point stored in the control.
  math::ReadingModel::Input linear_axes(double bound) const {
    const double u = bound / std::numbers::sqrt3;
    const math::Vector3& middle = out_.fit.point;
    math::ReadingModel::Input input;
    double widest = 0.0;
    for (const auto& [of, by] :
         {std::pair{0U, 1U}, {0U, 2U}, {1U, 2U}, {0U, 0U}, {1U, 1U}, {2U, 2U}}) {
      std::vector<double> row;
      for (const auto& r : out_.readings) {
        row.push_back(u * r.sense[of] * (r.at[by] - middle[by]));
        widest = std::max(widest, std::fabs(r.at[by] - middle[by]));
      }
      input.patterns.push_back(std::move(row));
    }
    input.is = {.id = "linear-axes",
                .u = u * widest,
                .with_length = true,
                .distribution = Distribution::rectangular,
                .correlation = Correlation::device,
                .source = "options.rtcp.linear_axes_urad"};
    input.of_line.assign(out_.model.lines.size(), u);
    return input;
  }

  math::ReadingModel::Input ball_place(double U) const {
    math::ReadingModel::Input input;
    for (std::size_t b = 0; b < out_.fit.place.size(); ++b)
      for (std::size_t k = 0; k < 3; ++k) {
        std::vector<double> row(out_.readings.size(), 0.0);
        for (std::size_t i = 0; i < row.size(); ++i)
          if (out_.fit.ball[out_.readings[i].line] == b) row[i] = U / 2.0 * out_.fit.by_ball[k][i];
        input.patterns.push_back(std::move(row));
      }
    input.is = {.id = "ball-place",
                .u = U / 2.0,
                .distribution = Distribution::normal,
                .correlation = Correlation::device,
                .source = "options.rtcp.ball_um"};
    input.of_line.assign(out_.model.lines.size(), U / 2.0);
    return input;
  }

  void budget() {
    std::vector<math::BudgetLine> lines;
    std::size_t last = o_.lines.size();
    for (std::size_t i = 0; i < out_.readings.size(); ++i) {
      const auto& r = out_.readings[i];
      const std::size_t group =
          probe_ ? static_cast<std::size_t>(names_[r.line].back() - 'x') : r.line;
      if (group != last) {
        lines.emplace_back();
        lines.back().kind =
            probe_ ? math::BudgetLine::Kind::coordinate : math::BudgetLine::Kind::lateral;
        lines.back().group = group;
        if (probe_) {
          const std::string axis(1, "XYZ"[group]);
          const double whole = 1.0;
          math::put_expansion(lines.back(), campaign_, {&axis, 1}, {&whole, 1});
        }
        last = group;
      }
      lines.back().length.push_back(probe_ ? r.at[group] - out_.fit.point[group] : 0.0);
    }
    out_.model = math::reading_model(campaign_, environment_, std::move(lines));
    if (wish_.linear_axes)
      out_.model.inputs.push_back(linear_axes(*wish_.linear_axes));
    else
      out_.model.missing.emplace_back("options.rtcp.linear_axes_urad");
    if (wish_.U_ball) out_.model.inputs.push_back(ball_place(*wish_.U_ball));
    if (std::isfinite(out_.dof) && !out_.fit.residual_by.empty())
      out_.model.see_residuals(out_.fit.residual_by, out_.dof);
  }

  void tell_wide() {
    const auto u = whole_u(out_);
    for (std::size_t k = 0; k < 4; ++k) {
      const double limit = k < 2 ? wish_.tolerance : wish_.tolerance_direction;
      if (!out_.fit.identifiable[k] || 2.0 * u[k] <= limit) continue;
      out_.wide[k] = 2.0 * u[k];
      const Quantity q = k < 2 ? Quantity::deviation : Quantity::small_angle;
      out_.findings.push_back(finding("rtcp.too-uncertain",
                                      {{"U", 2.0 * u[k], q}, {"tolerance", limit, q}},
                                      {{"name", out_.names[k]}}));
    }
  }

  void report_not_identifiable() {
    std::string by_ball, by_direction;
    for (std::size_t k = 0; k < 4; ++k) {
      if (out_.fit.identifiable[k]) continue;
      std::string& list = out_.fit.identifiable_with_ball[k] ? by_ball : by_direction;
      list += (list.empty() ? "" : ", ") + out_.names[k];
    }
    std::string lines;
    for (const std::string& line : names_) lines += (lines.empty() ? "" : ", ") + line;
    if (!by_ball.empty())
      out_.findings.push_back(finding("rtcp.not-identifiable-ball", {}, {{"names", by_ball}}));
    if (!by_direction.empty())
      out_.findings.push_back(
          finding("rtcp.not-identifiable", {}, {{"names", by_direction}, {"lines", lines}}));
  }

  const Campaign& campaign_;
  const Observations& o_;
  std::string axis_;
  const Environment& environment_;
  const Wish& wish_;
  Checked out_;
  bool probe_ = false;
  std::vector<std::string> names_;
};

Checked check(const Campaign& c, const Observations& o, const std::string& axis,
              const Environment& e, const Wish& wish) {
  return Check(c, o, axis, e, wish).done();
}

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
