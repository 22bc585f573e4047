// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/axis_findings.h"

#include <algorithm>
#include <cmath>

#include "common/finding_builder.h"
#include "nonio/math/compensated.h"
#include "nonio/math/drift.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/reversal.h"
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

}  // namespace nonio::math
