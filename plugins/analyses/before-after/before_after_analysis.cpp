// SPDX-License-Identifier: Apache-2.0
// One line measured before and after an adjustment: whether the compensation table had its effect.
#include <algorithm>
#include <array>
#include <cmath>

#include "nonio/math/along.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/axis_test.h"
#include "nonio/math/before_after.h"
#include "nonio/math/distributions.h"
#include "nonio/math/measured_line.h"
#include "nonio/math/reversal.h"
#include "nonio/math/uncertainty.h"
#include "nonio/sdk/plugin.h"

namespace nonio::before_after {

using math::BeforeAfter;

namespace {

bool same_line(const Measurement& a, const Measurement& b) {
  return a.kind == b.kind && a.axis == b.axis && a.lateral == b.lateral && a.side == b.side &&
         a.at == b.at && a.from == b.from && a.to == b.to;
}

/// nullopt if there is no such measurement, or if there are several.
std::optional<std::size_t> before_of(const Campaign& campaign, const Measurement& after) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.adjustment != "before" || !same_line(m, after)) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

bool applies(const Campaign& campaign, const Measurement& m) {
  return m.adjustment == "after" &&
         (m.kind == "axis" || m.kind == "diagonal" || m.kind == "straightness") &&
         before_of(campaign, m).has_value();
}

math::MeasuredLine line_by_way(const Observations& o, const Measurement& m) {
  return math::measured_line(m.kind == "diagonal" ? math::along_diagonal(o, m) : o, 0);
}

math::BudgetLine line_of(const AnalysisInput& in, const math::MeasuredLine& line, int direction,
                         std::size_t group) {
  const Measurement& m = in.measurement;
  math::BudgetLine out;
  out.kind = in.observations.angular    ? math::BudgetLine::Kind::angle
             : m.kind == "straightness" ? math::BudgetLine::Kind::lateral
                                        : math::BudgetLine::Kind::length;
  out.zeroed = line.zeroed;
  out.u = line.u_mean(direction);
  out.dof = static_cast<double>(line.dof);
  out.visits = line.visits(direction);
  out.walk_seen = line.walk_seen;
  out.group = group;
  for (const auto& stop : line.stops)
    out.length.push_back(std::fabs(stop.position - line.stops.front().position));
  std::vector<std::string> axes;
  std::vector<double> share;
  if (m.kind == "axis") axes = {m.axis}, share = {1.0};
  if (m.kind == "diagonal") axes = math::moving_axes(m), share = math::direction_along(m);
  if (!axes.empty() && !in.observations.angular) math::put_expansion(out, in.campaign, axes, share);
  return out;
}

Finding refusal(const char* id, const std::string& which) {
  return {.id = std::string("before-after.") + id, .attention = true, .texts = {{"which", which}}};
}

bool same_stops(const math::MeasuredLine& a, const math::MeasuredLine& b) {
  if (a.stops.size() != b.stops.size() || a.stops.size() < 3) return false;
  for (std::size_t i = 0; i < a.stops.size(); ++i)
    if (std::fabs(a.stops[i].position - b.stops[i].position) > math::same_stop) return false;
  return true;
}

const char* name_of(BeforeAfter::Answer answer) {
  switch (answer) {
    case BeforeAfter::Answer::worked:
      return "before-after.worked";
    case BeforeAfter::Answer::half_left:
      return "before-after.half-left";
    case BeforeAfter::Answer::not_active:
      return "before-after.not-active";
    case BeforeAfter::Answer::wrong_sign:
      return "before-after.wrong-sign";
    case BeforeAfter::Answer::something_else:
      return "before-after.something-else";
    case BeforeAfter::Answer::cannot_tell:
      break;
  }
  return "before-after.cannot-tell";
}

/// The reversal has its own compensation value, so it is assessed separately from the mean curve.
struct ReversalJudged {
  bool as_predicted = true;
  std::optional<Finding> finding{};
};

/// Standard uncertainty of B_mean from environment, repetition, and drift that was not excluded, m
/// or rad.
double u_of_reversal(const AnalysisInput& in, const Environment& environment,
                     const math::AxisTest& test) {
  const math::Budget budget =
      math::uncertainty_budget(in.campaign, environment, in.measurement.axis, test)
          .budget.value_or(math::Budget{.seen = math::drift_share(test)});
  const std::size_t n = std::max<std::size_t>(math::approaches_per_mean(test), 1);
  return math::iso230_2_uncertainty(budget, n, 2.0).B_mean / 2.0;
}

ReversalJudged judge_reversal(const AnalysisInput& in, const Observations& o,
                              const Environment& environment) {
  if (in.measurement.kind != "axis") return {};
  using Kind = math::Reversal::Kind;
  const auto before = math::AxisTest::arrange(o), after = math::AxisTest::arrange(in.observations);
  const math::Reversal was = math::assess_reversal(before), is = math::assess_reversal(after);
  if (was.kind == Kind::unknown || is.kind == Kind::unknown) return {};
  const double u_before = u_of_reversal(in, environment, before),
               u_after = u_of_reversal(in, environment, after);
  // u of (after - share * before). A new value contains the error of the earlier readings, so their
  // factor is at least 1. Rounding to the step of the control is added unless the value is
  // unchanged (share 1).
  const double step =
      in.control == nullptr ? 0.0 : in.control->value_step.of(in.observations.angular);
  const auto u_of = [&](double share) {
    const double u_rounded = share == 1.0 ? 0.0 : step / std::sqrt(12.0);
    return std::hypot(std::max(1.0, share) * u_before, u_after, u_rounded);
  };
  constexpr double level = 0.01;
  const auto fits = [&](double share) {
    const double rest = is.mean - share * was.mean;
    return !math::significant(math::t_two_sided(math::test_ratio(rest, u_of(share)), 1e6), level);
  };
  // A significant B_mean that one value can compensate is expected to be 0 afterwards. Otherwise it
  // is expected unchanged, unless a suitable value was entered by hand.
  const bool helps = was.kind != Kind::not_constant && was.largest_left < was.largest;
  const bool taken = helps && (math::is_reversal_known(was.mean, 2.0 * u_before) || fits(0.0));
  const double wanted = taken ? 0.0 : 1.0;
  const char* id = nullptr;
  bool as_predicted = false;
  if (fits(wanted)) {
    const bool told = !taken || was.kind == Kind::none || !fits(1.0);
    id = told ? "before-after.reversal-as-predicted" : "before-after.reversal-cannot-tell";
    as_predicted = told;
  } else {
    id = taken && fits(1.0)   ? "before-after.reversal-not-active"
         : taken && fits(2.0) ? "before-after.reversal-wrong-sign"
                              : "before-after.reversal-something-else";
  }
  const Quantity q = deviation_of(in.observations.angular);
  return {as_predicted, Finding{.id = id,
                                .attention = !as_predicted,
                                .evidence = {{"before", was.mean, q},
                                             {"after", is.mean, q},
                                             {"predicted", wanted * was.mean, q},
                                             {"u", u_of(wanted), q},
                                             {"right", taken ? -was.mean : 0.0, q},
                                             {"change", -(is.mean - wanted * was.mean), q}}}};
}

/// "Worked" requires that both the pitch and the reversal are as predicted.
const char* name_of(BeforeAfter::Answer answer, const ReversalJudged& reversal) {
  if (answer == BeforeAfter::Answer::worked && !reversal.as_predicted)
    return "before-after.mean-as-predicted";
  return name_of(answer);
}

void fill(const AnalysisInput& in, const math::MeasuredLine& one, const math::MeasuredLine& two,
          int direction, const math::ReadingModel& model, double dof,
          const ReversalJudged& reversal, Evaluation& e) {
  const bool angular = in.observations.angular;
  const Quantity q = angular ? Quantity::angular_deviation : Quantity::deviation;
  std::vector<double> before, after, position, way_b, way_a, in_u, U;
  for (std::size_t i = 0; i < one.stops.size(); ++i) {
    before.push_back(one.stops[i].mean(direction));
    after.push_back(two.stops[i].mean(direction));
    position.push_back(one.stops[i].position);
    way_b.push_back(before.back() - before.front());
    way_a.push_back(after.back() - after.front());
  }
  const double entry_step = in.control == nullptr ? 0.0 : in.control->value_step.of(angular);
  const BeforeAfter r = math::before_after(before, after, model, dof, entry_step);
  const double k = math::coverage_factor(std::min(dof, 1e6));
  for (std::size_t i = 0; i < r.rest.size(); ++i) {
    in_u.push_back(r.u[i] > 0.0 ? r.rest[i] / r.u[i] : 0.0);
    U.push_back(k * r.u[i]);
  }
  e.values.push_back({"left_share", r.f, Quantity::ratio});
  (model.missing.empty() ? e.values.back().U : e.values.back().repeatability) = k * r.u_f;
  e.values.back().k = k;
  const Quantity length = angular ? Quantity::angle : Quantity::length;
  e.points.columns = {{"target", length, position},  {"before", q, way_b},
                      {"predicted", q, r.predicted}, {"U_predicted", q, U},
                      {"after", q, way_a},           {"in_u", Quantity::ratio, in_u}};
  const auto largest = static_cast<std::size_t>(
      std::max_element(way_b.begin(), way_b.end(),
                       [](double a, double b) { return std::fabs(a) < std::fabs(b); }) -
      way_b.begin());
  e.findings.push_back({.id = name_of(r.answer, reversal),
                        .attention = r.answer != BeforeAfter::Answer::worked,
                        .evidence = {{"share", r.f, Quantity::ratio},
                                     {"u_share", r.u_f, Quantity::ratio},
                                     {"rest", r.rest[r.worst], q},
                                     {"u", r.u[r.worst], q},
                                     {"at", position[r.worst], length},
                                     {"p_worked", r.p[0], Quantity::probability},
                                     {"p_not_active", r.p[1], Quantity::probability},
                                     {"p_wrong_sign", r.p[2], Quantity::probability}}});
  if (r.answer == BeforeAfter::Answer::wrong_sign) {
    auto& evidence = e.findings.back().evidence;
    evidence.push_back({"largest_at", position[largest], length});
    evidence.push_back({"now", way_b[largest], q});
    evidence.push_back({"right", -way_b[largest], q});
  }
  if (reversal.finding) e.findings.push_back(*reversal.finding);
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  const auto before = before_of(in.campaign, in.measurement);
  if (in.all == nullptr || !before) return fail("expected the measurement before the adjustment");
  Evaluation e;
  const Measurement& first = in.campaign.measurements[*before];
  e.uses.push_back(first.id);
  const Observations& o = (*in.all)[*before];
  if (o.axes.empty() || in.observations.axes.empty()) {
    e.findings.push_back(refusal("stops", first.id));
    return e;
  }
  const auto one = line_by_way(o, first), two = line_by_way(in.observations, in.measurement);
  if (!same_stops(one, two)) {
    e.findings.push_back(refusal("stops", first.id));
    return e;
  }
  std::optional<int> direction;
  for (const int d : {0, 1, -1})
    if (!direction && one.has(d) && two.has(d)) direction = d;
  if (!direction) {
    e.findings.push_back(refusal("directions", first.id));
    return e;
  }
  const double dof = static_cast<double>(std::min(one.dof, two.dof));
  if (dof == 0.0) {
    e.findings.push_back(refusal("no-repetition", first.id));
    return e;
  }
  const math::HeldLimits limits =
      math::limits_held(in.campaign, std::array<const Observations*, 2>{&o, &in.observations});
  e.findings = limits.findings;
  const math::ReadingModel model =
      math::reading_model(in.campaign, limits.environment,
                          {line_of(in, one, *direction, 0), line_of(in, two, *direction, 1)});
  if (!model.missing.empty()) e.findings.push_back(math::missing_finding(model.missing));
  fill(in, one, two, *direction, model, dof, judge_reversal(in, o, limits.environment), e);
  e.notes.push_back({"method.before-after", {}, {{"before", first.id}}});
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"before-after", "1.0.0",
            "Whether a compensation did what it should: one line before and after."};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::before_after
