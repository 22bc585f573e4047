// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/intervals.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/distributions.h"

namespace nonio::statistics {
namespace {

using Method = Proposal::Method;

constexpr double months_a_year = 12.0;
constexpr double five_days = 5.0 * 12.0 / 365.25;  // in months
constexpr std::size_t fewest_after_a_change = 2, fewest_campaigns = 3;

Proposal refused(Method method, std::string why,
                 std::vector<std::pair<std::string, double>> numbers = {}) {
  return {method, std::nullopt, std::move(why), std::move(numbers)};
}

bool is_share(double p) { return p > 0.0 && p < 1.0; }
bool is_time(double t) { return std::isfinite(t) && t > 0.0; }

/// Binomial P(at most `passed` of `machines`) with probability `target`.
double cdf(int passed, int machines, double target) {
  if (passed < 0) return 0.0;
  return math::binomial_lower(passed, machines, target);
}

}  // namespace

Proposal staircase(double months, Found found, double target) {
  if (!is_time(months)) return refused(Method::staircase, "no-interval");
  if (!is_share(target)) return refused(Method::staircase, "no-target");
  Proposal out{Method::staircase, months, "undecided", {{"months", months}}};
  if (found == Found::fails) {
    out.months = months / 2.0, out.why = "failed";
  } else if (found == Found::conforms) {
    out.months = months * std::min(2.0, std::pow(2.0, (1.0 - target) / target));
    out.why = "passed";
  }
  return out;
}

Proposal control_chart(const Series& s, const Trend& t, double limit,
                       std::optional<std::size_t> changed_after, Beyond beyond) {
  if (s.points.size() < fewest_campaigns || t.coefficients.empty())
    return refused(Method::control_chart, "few-campaigns",
                   {{"campaigns", static_cast<double>(s.points.size())}});
  const double last = s.points.back().time, span = last - s.points.front().time;
  if (std::fabs(s.points.back().value) + beyond.value > limit)
    return refused(Method::control_chart, "out-already", {{"value", s.points.back().value}});
  const std::size_t behind = s.points.size() - (changed_after ? *changed_after + 1 : 0);
  if (behind < fewest_after_a_change)
    return refused(Method::control_chart, "change-not-explained",
                   {{"campaigns", static_cast<double>(behind)}});
  const Forecast f = forecast(s, t, last, limit, std::nullopt, beyond);
  if (f.leaves && *f.leaves <= last)
    return refused(Method::control_chart, "out-already", {{"value", f.value}, {"u", f.u}});
  const double far = months_a_year * span / 2.0;
  if (!(far > 0.0)) return refused(Method::control_chart, "few-campaigns", {{"campaigns", 1.0}});
  if (!f.leaves || months_a_year * (*f.leaves - last) > far)
    return {Method::control_chart, far, "as-far-as-seen", {{"span", months_a_year * span}}};
  return {Method::control_chart,
          months_a_year * (*f.leaves - last),
          "meets-limit",
          {{"value", f.value}, {"u", f.u}, {"limit", limit}}};
}

Proposal fleet(double months, int passed, int machines, double target) {
  if (!is_time(months)) return refused(Method::fleet, "no-interval");
  if (!is_share(target)) return refused(Method::fleet, "no-target");
  if (machines < 1 || passed < 0 || passed > machines) return refused(Method::fleet, "no-machines");
  const double n = machines, seen = passed / n;
  double Q = 0.0, exponent = 0.0;
  if (seen < target) {
    Q = 1.0 - 2.0 * cdf(passed, machines, target);
    exponent = (seen - target) * Q;
  } else if (passed == machines) {
    Q = 1.0 - std::pow(target, n);
    exponent = (seen - target) / (1.0 - Q);
  } else {
    Q = 1.0 - 2.0 * (1.0 - cdf(passed - 1, machines, target));
    exponent = (seen - target) * Q;
  }
  const double changed = months * std::clamp(std::pow(10.0, exponent), 0.5, 2.0);
  const bool shown = Q > 0.5 && std::fabs(changed - months) > five_days;
  return {Method::fleet,
          shown ? changed : months,
          !shown             ? "fleet-as-it-is"
          : changed < months ? "fleet-shorter"
                             : "fleet-longer",
          {{"passed", passed}, {"machines", n}, {"target", target}, {"Q", Q}}};
}

}  // namespace nonio::statistics
