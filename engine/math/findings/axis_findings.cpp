// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/axis_findings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/constants.h"
#include "common/finding_builder.h"
#include "nonio/math/budget.h"
#include "nonio/math/compensated.h"
#include "nonio/math/distributions.h"
#include "nonio/math/drift.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/reversal.h"
#include "nonio/math/statistics.h"
#include "nonio/sdk/format.h"

namespace nonio::math {

bool matters(const AxisTest& test, double size) {
  // Smallest relevant fraction of A or E: docs/dev/constants.md, A2.
  constexpr double share = 0.2;
  const Iso230Result iso = evaluate_iso230_2(test, 2.0);
  const double whole = std::isnan(iso.A) ? iso.E : iso.A;
  return !(size < share * whole);
}

bool is_reversal_known(double mean, double U) {
  // Largest ratio of U to the reversal: docs/dev/constants.md, A28.
  constexpr double largest_share = 0.5;
  return U < largest_share * std::fabs(mean);
}

namespace {

// A positive reversal is due to clearances and friction, or to an active backlash value that is too
// large. The latter is named only if the active value is stated.
const char* positive_reversal(std::optional<double> active) {
  return !active         ? "reversal.positive"
         : *active > 0.0 ? "reversal.over-compensated"
                         : "reversal.positive-uncompensated";
}

}  // namespace

void reversal_findings(const AxisTest& test, std::vector<Finding>& findings,
                       std::optional<double> active, ReversalUncertainty of_budget) {
  using Kind = Reversal::Kind;
  const Reversal r = assess_reversal(test);
  const bool attention = !std::isnan(r.largest) && matters(test, r.largest);
  // A single value is not recommended if it leaves a larger reversal somewhere than exists now.
  const bool constant = r.kind == Kind::lost_motion || r.kind == Kind::over_compensated;
  const DriftShare seen = drift_share(test);
  const double U = std::max(seen.B_mean, of_budget.B_mean);
  const char* id = constant && !(r.largest_left < r.largest) ? "reversal.one-value-worse"
                   : r.kind == Kind::lost_motion && is_reversal_known(r.mean, U)
                       ? "reversal.lost-motion"
                   : r.kind == Kind::lost_motion      ? "reversal.not-identifiable"
                   : r.kind == Kind::over_compensated ? positive_reversal(active)
                   : r.kind == Kind::not_constant     ? "reversal.not-constant"
                                                      : nullptr;
  if (id != nullptr) {
    const double left = predicted_after(r.largest, r.largest_left, std::max(seen.B, of_budget.B));
    FindingBuilder finding(id, attention, test.rotary);
    finding.deviation("mean", r.mean)
        .deviation("u_mean", r.u_mean)
        .deviation("max", r.largest)
        .deviation("left", left)
        .number("p", r.kind == Kind::not_constant ? r.p_varies : r.p_mean, Quantity::probability);
    if (r.kind == Kind::lost_motion && !is_reversal_known(r.mean, U)) finding.deviation("U", U);
    if (r.kind == Kind::over_compensated && active) finding.deviation("active", *active);
    findings.push_back(finding.done());
  }
  if (r.opposed)
    findings.push_back(FindingBuilder("reversal.elastic", attention, true)
                           .deviation("amplitude", r.opposed_amplitude)
                           .deviation("mean", r.mean)
                           .deviation("max", r.largest)
                           .number("p", r.p_opposed, Quantity::probability)
                           .done());
  if (r.concordant)
    findings.push_back(
        FindingBuilder("eccentricity", matters(test, 2.0 * r.concordant_amplitude), true)
            .deviation("amplitude", r.concordant_amplitude)
            .number("p", r.p_concordant, Quantity::probability)
            .done());
}

namespace {
/// An offset common to all targets does not affect E, A and M, because these are ranges.
void common_offset(const AxisTest& test, std::vector<Finding>& findings) {
  double low = INFINITY, high = -INFINITY, sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const auto& readings : {test.plus(i), test.minus(i)})
      for (const double value : deviations(readings))
        low = std::min(low, value), high = std::max(high, value), sum += value, n += 1.0;
  const double offset = sum / n;
  if (test.targets.size() < 2 || !(std::fabs(offset) > high - low)) return;
  findings.push_back(FindingBuilder("deviation.offset", false, test.rotary)
                         .deviation("offset", offset)
                         .deviation("range", high - low)
                         .done());
}
}  // namespace

std::vector<Finding> axis_findings(const AxisTest& test, const Observations& o, const Axis* axis,
                                   ReversalUncertainty U) {
  std::vector<Finding> findings;
  drift_findings(test, findings, U);
  reversal_findings(test, findings, axis != nullptr ? axis->active_backlash : std::nullopt, U);
  scatter_findings(test, findings);
  turn_findings(test, findings);
  plan_findings(test, o, axis, findings);
  common_offset(test, findings);
  return findings;
}

Incomplete incomplete_targets(const AxisTest& test) {
  Incomplete out;
  const bool repeated = test.most_approaches() >= 2;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    const std::size_t plus = test.plus(i).size(), minus = test.minus(i).size();
    if ((test.has_plus() && plus == 0) || (test.has_minus() && minus == 0))
      out.unpaired.push_back(i);
    else if (repeated && (plus == 1 || minus == 1))
      out.single.push_back(i);
  }
  return out;
}

std::string target_list(const AxisTest& test, const std::vector<std::size_t>& targets) {
  constexpr std::size_t most = 12;
  const Quantity q = position_of(test.rotary);
  std::string text;
  for (std::size_t k = 0; k < targets.size() && k < most; ++k)
    text += (k == 0 ? "" : "; ") + evidence_text({"", test.targets[targets[k]], q});
  if (targets.size() > most) text += "; ...";
  return text + " " + std::string(unit_of(q).symbol);
}

AxisTest choose_targets(const AxisTest& test, bool leave_out, std::vector<Finding>& findings) {
  const Incomplete incomplete = incomplete_targets(test);
  if (!incomplete.any()) return test;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    if (!std::binary_search(incomplete.unpaired.begin(), incomplete.unpaired.end(), i) &&
        !std::binary_search(incomplete.single.begin(), incomplete.single.end(), i))
      kept.push_back(i);
  leave_out = leave_out && kept.size() >= 2;
  const auto say = [&](const char* id, const std::vector<std::size_t>& which) {
    if (which.empty()) return;
    findings.push_back(FindingBuilder(id, true, test.rotary)
                           .count("concerned", static_cast<double>(which.size()))
                           .count("targets", static_cast<double>(test.targets.size()))
                           .text("which", target_list(test, which))
                           .done());
  };
  const std::string done = leave_out ? "-left-out" : "";
  say(("targets.unpaired" + done).c_str(), incomplete.unpaired);
  say(("readings.too-few" + done).c_str(), incomplete.single);
  if (leave_out)
    findings.push_back(FindingBuilder("plan.targets-left-out", false, test.rotary)
                           .count("evaluated", static_cast<double>(kept.size()))
                           .count("targets", static_cast<double>(test.targets.size()))
                           .done());
  return leave_out ? test.only(kept) : test;
}

void require_repetition(const AxisTest& test, std::optional<Budget>& budget, const char* absent,
                        std::vector<Finding>& findings) {
  if (test.most_approaches() != 1) return;
  findings.push_back(
      FindingBuilder("runs.single", budget.has_value(), test.rotary).text("absent", absent).done());
  budget.reset();
}

Finding budget_finding(const BudgetOrGap& of, bool rotary) {
  if (!of.budget) {
    std::string keys;
    for (const std::string& key : of.missing) keys += (keys.empty() ? "" : ", ") + key;
    return FindingBuilder("uncertainty.no-data", false, rotary).text("missing", keys).done();
  }
  const Budget& b = *of.budget;
  FindingBuilder finding(rotary ? "uncertainty.budget-angle" : "uncertainty.budget", false, rotary);
  finding.deviation("U_DEV", b.U_DEV);
  if (!rotary) finding.deviation("U_MIS", b.U_MIS).deviation("U_M", b.U_M).deviation("U_E", b.U_E);
  return finding.deviation("U_EVE", b.U_EVE).position("length", b.length).done();
}

//
// docs/dev/estimators.md describes the tests. A drift of less than a fifth of A is information,
// because it is already part of the scatter; its size is extrapolated to five runs, because with
// fewer runs a larger part of the drift is in the reversal.
namespace {

// Level of the test against the scatter within the passes: docs/dev/constants.md, A24.
constexpr double beyond_scatter = 0.002;
// Steps between five runs, to which a drift is extrapolated: docs/dev/constants.md, A25.
constexpr double steps_of_five_runs = 4.0;

// Each of the three courses that slow down has this part of the level of the even one:
// docs/dev/constants.md, M61.
constexpr double of_slowing = 0.1;

double share_of_level(const Drift& drift) {
  return std::isinf(drift.time_constant) ? 1.0 : of_slowing;
}

bool shows(double fraction, double p, double level) {
  return significant(p, level) && std::fabs(fraction - 1.0) <= 0.5;
}

bool steady(const Drift::Part& part, const Drift& drift) {
  const double level = significance * share_of_level(drift);
  if (significant(part.p_runs, level)) return true;
  const bool by_passes = std::isinf(drift.time_constant)
                             ? drift.runs >= 5 && part.monotone
                             : part.monotone && shows(part.seen_in_pairs, part.p_pairs, level);
  return by_passes && significant(part.p_passes, level);
}

bool parallel_found(const Drift& drift) {
  const Drift::Part& part = drift.offset;
  const double level = share_of_level(drift);
  if (!part.known || !significant(part.p_scatter, beyond_scatter * level)) return false;
  const bool shown = shows(drift.seen_in_reversal, drift.p_reversal, significance * level);
  return steady(part, drift) || (shown && part.agree);
}

bool wedge_found(const Drift& drift) {
  const Drift::Part& part = drift.slope;
  const double level = share_of_level(drift);
  if (!part.known || !significant(part.p_scatter, beyond_scatter * level)) return false;
  return steady(part, drift) ||
         (part.agree && (drift.runs == 2 || significant(part.p_passes, significance * level)));
}

// Of the courses with which a drift is found, the one that fits best; without one the even course.
const Drift& course_of(const std::vector<Drift>& drifts) {
  const Drift* best = nullptr;
  for (const Drift& drift : drifts)
    if ((parallel_found(drift) || wedge_found(drift)) &&
        (best == nullptr || drift.misfit() < best->misfit()))
      best = &drift;
  return best != nullptr ? *best : drifts.front();
}

double smallest_p(const Drift::Part& part) {
  return std::max(part.p_scatter, std::min({part.p_runs, part.p_passes, significance}));
}

}  // namespace

void drift_findings(const AxisTest& test, std::vector<Finding>& findings,
                    ReversalUncertainty of_budget) {
  const std::vector<Drift> drifts = estimate_drifts(test);
  if (drifts.empty()) return;
  const Drift& drift = course_of(drifts);
  const double steps = static_cast<double>(drift.runs) - 1.0;
  const double scatter = std::max(drift.scatter, rounding);
  const Drift::Part &shift = drift.offset, &turn = drift.slope;
  const double wedge = turn.total * test.length();
  const double near = shift.total + turn.total * (test.targets.front() - drift.middle);
  const double far = shift.total + turn.total * (test.targets.back() - drift.middle);
  const double largest = std::max(std::fabs(near), std::fabs(far));
  const double common = near * far > 0.0 ? std::min(std::fabs(near), std::fabs(far)) : 0.0;

  const bool is_wedge =
      wedge_found(drift) && std::fabs(wedge) > scatter && std::fabs(wedge) >= 0.25 * largest;
  const bool is_parallel = parallel_found(drift) && std::fabs(shift.total) > scatter &&
                           (!is_wedge || common > std::max(scatter, 0.5 * std::fabs(wedge)));
  const auto finding = [&](const char* id, double total, const Drift::Part& part) {
    const double per_run = total / steps;
    const double size = std::max(std::fabs(total), steps_of_five_runs * std::fabs(per_run));
    return FindingBuilder(id, matters(test, size), test.rotary)
        .deviation("total", total)
        .deviation("per_run", per_run)
        .slope("wedge", turn.total)
        .deviation("in_B", std::max(drift_share(test).B_mean, of_budget.B_mean))
        .deviation("scatter", scatter)
        .number("p", smallest_p(part), Quantity::probability)
        .count("runs", static_cast<double>(drift.runs))
        .done();
  };
  if (is_parallel) findings.push_back(finding("drift.parallel", shift.total, shift));
  if (is_wedge) findings.push_back(finding("drift.wedge", wedge, turn));
}

namespace {

/// Returns the largest total drift of the findings about drift, m or rad; 0 without findings.
double drift_of(const Observations& o) {
  if (o.axes.empty() || o.axes.front().approach.empty()) return 0.0;
  std::vector<Finding> found;
  drift_findings(AxisTest::arrange(o), found);
  double most = 0.0;
  for (const Finding& f : found)
    for (const Number& n : f.evidence)
      if (n.name == "total") most = std::max(most, std::fabs(n.value));
  return most;
}

double distance_from_20(const Observations& o) {
  double most = 0.0;
  for (const double t : o.material)
    if (std::isfinite(t)) most = std::max(most, std::fabs(t - 20.0));
  return most;
}

double duration_of(const Observations& o) {
  double first = INFINITY, last = -INFINITY;
  for (const double t : o.time)
    if (std::isfinite(t)) first = std::min(first, t), last = std::max(last, t);
  return last > first ? last - first : 0.0;
}

/// Uses the value found in the readings if it is larger than the stated limit, and reports this.
void hold(std::optional<double>& stated, double found, const char* key, Quantity quantity,
          std::vector<Finding>& findings) {
  constexpr double slack = 1e-9;  // relative tolerance for rounding in files
  if (!stated || !(found > *stated * (1.0 + slack) + 1e-15)) return;
  findings.push_back({.id = "uncertainty.limit-exceeded",
                      .attention = true,
                      .evidence = {{"stated", *stated, quantity}, {"found", found, quantity}},
                      .texts = {{"key", key}}});
  stated = found;
}

}  // namespace

HeldLimits limits_held(const Campaign& c, std::span<const Observations* const> all) {
  HeldLimits out{c.environment, {}};
  double distance = 0.0, drift = 0.0, drift_angle = 0.0, duration = 0.0;
  for (const Observations* o : all) {
    distance = std::max(distance, distance_from_20(*o));
    duration = std::max(duration, duration_of(*o));
    double& of = o->angular ? drift_angle : drift;
    of = std::max(of, drift_of(*o));
  }
  Environment& e = out.environment;
  // A drift grows with time, so it is scaled up for a test that took longer than the drift test.
  if (e.drift_time && duration > *e.drift_time) {
    const double longer = duration / *e.drift_time;
    hold(e.drift_time, duration, "environment.drift_minutes", Quantity::time, out.findings);
    if (e.drift) *e.drift *= longer;
    if (e.drift_angle) *e.drift_angle *= longer;
  }
  hold(e.temperature_difference, distance, "environment.temperature_difference_K",
       Quantity::temperature_difference, out.findings);
  hold(e.drift, drift, "environment.drift_um", Quantity::deviation, out.findings);
  hold(e.drift_angle, drift_angle, "environment.drift_arcsec", Quantity::angular_deviation,
       out.findings);
  return out;
}

//
// Errors shared by a pass cancel in the difference of two readings of the pass one turn apart. A
// drift within the passes has opposite signs in the two directions and cancels as well. With one
// pass in each direction the scatter is not known, and nothing is reported.
namespace {

constexpr double same_place = 1e-6;  // rad, tolerance for nominal positions

struct Pair {
  std::size_t earlier, later;
};

std::vector<Pair> pairs_a_turn_apart(const AxisTest& test) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0, j = 0; i < test.targets.size(); ++i) {
    while (j < test.targets.size() && test.targets[j] < test.targets[i] + full_turn - same_place)
      ++j;
    if (j < test.targets.size() && test.targets[j] <= test.targets[i] + full_turn + same_place)
      pairs.push_back({i, j});
  }
  return pairs;
}

// Returns the mean of x(later) - x(earlier), rad, of each pass of one direction.
std::vector<double> gaps(const AxisTest& test, const std::vector<Pair>& pairs, bool minus) {
  struct Sum {
    double sum = 0.0, n = 0.0;
  };
  std::map<std::uint32_t, Sum> by_run;
  for (const Pair& pair : pairs) {
    const auto earlier = minus ? test.minus(pair.earlier) : test.plus(pair.earlier);
    const auto later = minus ? test.minus(pair.later) : test.plus(pair.later);
    for (std::size_t a = 0, b = 0; a < earlier.size() && b < later.size();) {
      if (earlier[a].run != later[b].run) {
        ++(earlier[a].run < later[b].run ? a : b);
        continue;
      }
      Sum& sum = by_run[earlier[a].run];
      sum.sum += later[b++].deviation - earlier[a++].deviation;
      sum.n += 1.0;
    }
  }
  std::vector<double> out;
  for (const auto& [run, sum] : by_run) out.push_back(sum.sum / sum.n);
  return out;
}

}  // namespace

void turn_findings(const AxisTest& test, std::vector<Finding>& findings) {
  if (!test.rotary) return;
  const auto pairs = pairs_a_turn_apart(test);
  if (pairs.empty()) return;
  double sum = 0.0, directions = 0.0, squares = 0.0, dof = 0.0, weight = 0.0;
  for (const bool minus : {false, true}) {
    const auto g = gaps(test, pairs, minus);
    if (g.empty()) continue;
    const double n = static_cast<double>(g.size()), middle = mean(g);
    for (const double one : g) squares += (one - middle) * (one - middle);
    sum += middle, directions += 1.0, dof += n - 1.0, weight += 1.0 / n;
  }
  if (!(dof > 0.0)) return;
  const double gap = sum / directions;
  const double u = std::sqrt(squares / dof * weight) / directions;
  const double p = t_two_sided(test_ratio(gap, u), dof);
  if (!(std::fabs(gap) > rounding) || !significant(p, significance)) return;
  findings.push_back(FindingBuilder("rotary.not-closed", matters(test, std::fabs(gap)), true)
                         .position("from", test.targets[pairs.front().earlier])
                         .position("to", test.targets[pairs.front().later])
                         .deviation("gap", gap)
                         .deviation("u", u)
                         .number("p", p, Quantity::probability)
                         .done());
}

}  // namespace nonio::math
