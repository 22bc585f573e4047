// SPDX-License-Identifier: Apache-2.0
//
// Rules of positioning over the statistics of axis_statistics.h. Formulas and sources:
// docs/formulas.md, Rules of positioning; the texts of the standards were not available. The table
// of rules states the confidence of each.
#include "nonio/math/positioning.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/constants.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/vdi3441.h"

namespace nonio::math {
namespace {

using Form = RuleForm;
using Sure = Confidence;

/// E and M exist since the editions with k = 2.
constexpr PositioningRule ranges(double k, std::string_view name, std::string_view title,
                                 std::size_t approaches, Confidence confidence) {
  return {name, title, Form::iso, k, k < 3.0, false, approaches, confidence};
}
constexpr PositioningRule of_nmtba(std::string_view name, std::string_view title,
                                   bool without_offset) {
  return {name, title, Form::nmtba, 3.0, false, without_offset, 0, Sure::inferred};
}
constexpr PositioningRule one_pass(std::string_view name, std::string_view title) {
  return {name, title, Form::jis, 0.0, false, false, 7, Sure::inferred};
}

const std::array rules = {
    ranges(3.0, "iso-1988", "ISO 230-2:1988", 5, Sure::proved),
    ranges(2.0, "iso-1997", "ISO 230-2:1997", 5, Sure::known),
    ranges(2.0, "iso-2006", "ISO 230-2:2006", 5, Sure::proved),
    ranges(2.0, "iso-2014", "ISO 230-2:2014", 5, Sure::proved),
    PositioningRule{"upr", "UPR (ISO 230-2:2014)", Form::upr, 2.0, false, false, 5, Sure::proved},
    PositioningRule{"vdi-3441", "VDI/DGQ 3441:1977", Form::vdi, 3.0, false, false, 5, Sure::known},
    PositioningRule{"b5.54-1992", "ASME B5.54-1992", Form::raw, 0.0, false, false, 0,
                    Sure::inferred},
    ranges(2.0, "b5.54-2005", "ASME B5.54-2005", 5, Sure::known),
    ranges(2.0, "b5.57-2012", "ASME B5.57-2012", 5, Sure::known),
    of_nmtba("nmtba", "NMTBA 1972", false),
    of_nmtba("nmtba-no-offset", "NMTBA 1972 (w/o offset)", true),
    ranges(3.0, "bs-3800", "BS 3800-2:1991", 5, Sure::known),
    ranges(3.0, "bs-4656-16", "BS 4656-16:1985", 0, Sure::inferred),
    one_pass("jis-6330", "JIS B 6330-1980"),
    one_pass("jis-6336-1980", "JIS B 6336-1980"),
    one_pass("jis-6336-1986", "JIS B 6336-1986"),
    ranges(2.0, "jis-6190-2", "JIS B 6190-2 (ISO 230-2:2014)", 5, Sure::known),
    ranges(3.0, "gb-10931", "GB 10931-89", 5, Sure::known),
    ranges(2.0, "gb-17421.2-2000", "GB/T 17421.2-2000", 5, Sure::known),
    ranges(2.0, "gb-17421.2-2016", "GB/T 17421.2-2016", 5, Sure::known),
};

// In a difference of two readings, the environment can contribute its whole range.
constexpr RuleShare share_of_reversal{false, 2.0, 0.0, 0.0, &DriftShare::B};

std::vector<RuleValue> iso(const PositioningRule& rule, const AxisStatistics& axis) {
  const Iso230Result r = evaluate_iso230_2(axis, rule.k);
  const RuleShare A{true, 2.0, rule.k, 0.0, &DriftShare::E}, E{true, 2.0, 0.0, 0.0, &DriftShare::E},
      M{true, 1.0, 0.0, 0.0, &DriftShare::M}, both{false, 2.0, rule.k, 0.0, &DriftShare::B},
      one{false, 0.0, rule.k, 0.0};
  std::vector<RuleValue> out = {{"A", r.A, A}, {"A+", r.A_plus, A}, {"A-", r.A_minus, A}};
  if (rule.systematic)
    out.insert(out.end(),
               {{"E", r.E, E}, {"E+", r.E_plus, E}, {"E-", r.E_minus, E}, {"M", r.M, M}});
  out.insert(out.end(), {{"R", r.R, both},
                         {"R+", r.R_plus, one},
                         {"R-", r.R_minus, one},
                         {"B", r.B, share_of_reversal},
                         {"B_mean", r.B_mean, {false, 2.0, 0.0, 0.0, &DriftShare::B_mean}}});
  return out;
}

std::vector<RuleValue> upr(const PositioningRule& rule, const AxisStatistics& axis) {
  const Iso230Result r = evaluate_iso230_2(axis, rule.k);
  const bool both = std::isfinite(r.R_plus) && std::isfinite(r.R_minus);
  return {{"UPR", both ? std::min(r.R_plus, r.R_minus) : not_given, {false, 0.0, rule.k, 0.0}}};
}

std::vector<RuleValue> vdi(const PositioningRule& rule, const AxisStatistics& axis) {
  const VdiResult r = evaluate_vdi3441(axis, StandardDeviation::direct);
  const RuleShare scatter{false, 0.0, rule.k, 0.0};
  return {{"P", r.P, {true, 2.0, rule.k, 0.0, &DriftShare::E}},
          {"Pa", r.Pa, {true, 1.0, 0.0, 0.0, &DriftShare::M}},
          {"Ps_max", r.Ps_max, scatter},
          {"Ps_mean", r.Ps_mean, scatter},
          {"U_max", r.U_max, share_of_reversal},
          {"U_mean", r.U_mean, {false, 2.0, 0.0, 0.0, &DriftShare::U_mean}},
          {"PsU_max", r.PsU_max, {false, 2.0, rule.k, 0.0, &DriftShare::B}, true}};
}

double both_of(double plus, double minus) {
  return std::isnan(plus) || std::isnan(minus) ? not_given : std::max(plus, minus);
}

std::vector<RuleValue> nmtba(const PositioningRule& rule, const AxisStatistics& axis, Offset how) {
  const double o = rule.without_offset ? offset_of(axis, how) : 0.0;
  Extent accuracy[2], repeatability[2];
  for (const auto& t : axis.targets)
    for (const bool minus : {false, true}) {
      const auto& side = minus ? t.minus : t.plus;
      if (side.n == 0) continue;
      accuracy[minus ? 1 : 0].put(std::fabs(side.mean - o) + rule.k * side.s);
      repeatability[minus ? 1 : 0].put(rule.k * side.s);
    }
  // The commanded position refers to a zero set by one reading; a subtracted offset is a mean.
  const RuleShare of_accuracy = rule.without_offset
                                    ? RuleShare{true, 2.0, rule.k / 2.0, 0.0, &DriftShare::E}
                                    : RuleShare{true, 1.0, rule.k / 2.0, 1.0, &DriftShare::M};
  const RuleShare scatter{false, 0.0, rule.k / 2.0, 0.0};
  const double plus = accuracy[0].largest(), minus = accuracy[1].largest();
  return {{"+-accuracy", both_of(plus, minus), of_accuracy},
          {"+-accuracy+", plus, of_accuracy},
          {"+-accuracy-", minus, of_accuracy},
          {"+-repeatability",
           evaluate_iso230_2(axis, rule.k).R / 2.0,
           {false, 0.5, rule.k / 2.0, 0.0, &DriftShare::B, 0.5}},
          {"+-repeatability+", repeatability[0].largest(), scatter},
          {"+-repeatability-", repeatability[1].largest(), scatter}};
}

double spread(const AxisStatistics::Side& one) {
  return one.n < 2 ? not_given : one.high - one.low;
}

std::vector<RuleValue> raw(const AxisStatistics& axis) {
  Extent A, A_plus, A_minus, R, R_plus, R_minus, B;
  for (const auto& t : axis.targets) {
    const auto &p = t.plus, &m = t.minus;
    if (p.n > 0) A_plus.put(p.low), A_plus.put(p.high), R_plus.put(spread(p));
    if (m.n > 0) A_minus.put(m.low), A_minus.put(m.high), R_minus.put(spread(m));
    for (const double x : {p.low, p.high, m.low, m.high}) A.put(x);
    const bool enough = p.n > 1 && m.n > 1;
    R.put(enough ? std::max(p.high, m.high) - std::min(p.low, m.low) : not_given);
    B.put(std::fabs(t.B));
  }
  const RuleShare all{true, 0.0, 0.0, 1.0}, here{false, 0.0, 0.0, 1.0};
  return {{"A'", A.range(), all},
          {"A'+", A_plus.range(), all},
          {"A'-", A_minus.range(), all},
          {"R'", R.largest(), here},
          {"R'+", R_plus.largest(), here},
          {"R'-", R_minus.largest(), here},
          {"B", B.largest(), share_of_reversal}};
}

// Of two targets at equal distance from the middle of the travel, the lower one is used.
std::size_t middle_of(const AxisStatistics& axis) {
  const double middle = (axis.targets.front().target + axis.targets.back().target) / 2.0;
  std::size_t best = 0;
  for (std::size_t i = 1; i < axis.targets.size(); ++i)
    if (std::fabs(axis.targets[i].target - middle) <
        std::fabs(axis.targets[best].target - middle) - rounding)
      best = i;
  return best;
}

// The first pass consists of the earliest readings of one direction, + if it was measured. NaN
// unless all of them are from the same run.
double first_pass(const AxisStatistics& axis) {
  const auto whole = [&](auto side) {
    return std::all_of(axis.targets.begin(), axis.targets.end(), [&](const auto& t) {
      return (t.*side).n > 0 && (t.*side).run == (axis.targets.front().*side).run;
    });
  };
  using T = AxisStatistics::Target;
  const bool any_plus = std::any_of(axis.targets.begin(), axis.targets.end(),
                                    [](const T& t) { return t.plus.n > 0; });
  const auto side = any_plus ? &T::plus : &T::minus;
  if (!whole(side)) return not_given;
  Extent x;
  for (const T& t : axis.targets) x.put((t.*side).first);
  return x.range();
}

std::vector<RuleValue> jis(const AxisStatistics& axis) {
  Extent repetition, lost;
  const std::size_t last = axis.targets.empty() ? 0 : axis.targets.size() - 1;
  bool plus = false, minus = false;
  for (const auto& t : axis.targets) plus = plus || t.plus.n > 0, minus = minus || t.minus.n > 0;
  for (const std::size_t i : {std::size_t{0}, axis.targets.empty() ? 0 : middle_of(axis), last}) {
    if (axis.targets.empty()) break;
    const auto& t = axis.targets[i];
    if (plus) repetition.put(spread(t.plus));
    if (minus) repetition.put(spread(t.minus));
    lost.put(std::fabs(t.B));
  }
  return {{"accuracy", axis.targets.empty() ? not_given : first_pass(axis), {true, 0.0, 0.0, 1.0}},
          {"+-repeatability", repetition.largest() / 2.0, {false, 0.0, 0.0, 0.25}},
          {"lost_motion", lost.largest(), share_of_reversal}};
}

}  // namespace

std::span<const PositioningRule> positioning_rules() { return rules; }

const PositioningRule* positioning_rule(std::string_view name) {
  for (const PositioningRule& rule : rules)
    if (rule.name == name) return &rule;
  return nullptr;
}

double offset_of(const AxisStatistics& axis, Offset how) {
  if (axis.targets.empty()) return not_given;
  bool plus = false, minus = false;
  for (const auto& t : axis.targets) plus = plus || t.plus.n > 0, minus = minus || t.minus.n > 0;
  Extent extent;
  double sum = 0.0, first = not_given;
  for (const auto& t : axis.targets) {
    const double m = plus && minus ? t.mean : plus ? t.plus.mean : t.minus.mean;
    if (&t == &axis.targets.front()) first = m;
    extent.put(m);
    sum += m;
  }
  switch (how) {
    case Offset::first_target:
      return first;
    case Offset::mid_range:
      return (extent.largest() + extent.smallest()) / 2.0;
    case Offset::mean_of_all:
      break;
  }
  return sum / static_cast<double>(axis.targets.size());
}

std::vector<RuleValue> evaluate_rule(const PositioningRule& rule, const AxisStatistics& axis,
                                     Offset how) {
  switch (rule.form) {
    case Form::iso:
      return iso(rule, axis);
    case Form::upr:
      return upr(rule, axis);
    case Form::vdi:
      return vdi(rule, axis);
    case Form::nmtba:
      return nmtba(rule, axis, how);
    case Form::raw:
      return raw(axis);
    case Form::jis:
      return jis(axis);
  }
  return {};
}

}  // namespace nonio::math
