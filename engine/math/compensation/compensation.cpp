// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/compensation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/constants.h"
#include "nonio/sdk/format.h"

namespace nonio::math {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double mean_of(std::span<const AxisTest::Reading> readings) {
  double first = readings.front().deviation, sum = 0.0;
  for (const auto& r : readings) sum += r.deviation - first;
  return first + sum / static_cast<double>(readings.size());
}

bool all_finite(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}

double range(const std::vector<double>& x) {
  if (x.empty() || !all_finite(x)) return nan;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  return *high - *low;
}

std::int64_t whole(double value, double unit) { return std::llround(value / unit); }

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}
std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return -floor_div(-a, b); }

// Rounds up to two significant digits, for a step that a person enters.
std::int64_t rounded_up(std::int64_t units) {
  std::int64_t scale = 1;
  while (units / scale >= 100) scale *= 10;
  return ceil_div(units, scale) * scale;
}
std::int64_t rounded_down(std::int64_t units) {
  std::int64_t scale = 1;
  while (units / scale >= 100) scale *= 10;
  return units / scale * scale;
}

std::int64_t power_up(std::int64_t units) {
  std::int64_t p = 1;
  while (p < units) p *= 2;
  return p;
}

struct Plan {
  const GridRule& rule;
  std::int64_t from, to, origin;
  std::int64_t full = 0;  // one turn

  std::int64_t low(std::int64_t step) const {
    return rule.anchor ? std::min<std::int64_t>(0, floor_div(from - origin, step)) : 0;
  }
  std::int64_t high(std::int64_t step) const {
    const std::int64_t h = ceil_div(to - origin, step);
    return rule.anchor ? std::max<std::int64_t>(0, h) : h;
  }
  std::int64_t points(std::int64_t step) const { return high(step) - low(step) + 1; }
  bool fits(std::int64_t step) const {
    return points(step) <= static_cast<std::int64_t>(rule.most) &&
           (!rule.turn || full % step == 0) && (!rule.power_of_two || (step & (step - 1)) == 0);
  }
  // Returns the smallest step, not below the argument, that the control accepts.
  std::int64_t allowed(std::int64_t step) const {
    if (rule.power_of_two) return power_up(step);
    if (!rule.turn) return step;
    while (step < full && full % step != 0) ++step;
    return step;
  }
  std::int64_t smallest_that_fits() const {
    std::int64_t span = std::max(to, origin) - std::min(from, origin);
    const auto gaps = static_cast<std::int64_t>(rule.most) - 1;
    std::int64_t step = allowed(rounded_up(std::max<std::int64_t>(1, ceil_div(span, gaps))));
    for (int i = 0; i < 64 && !fits(step); ++i) step = allowed(rounded_up(step + 1));
    return step;
  }
  std::string text(std::int64_t units) const {
    const double value = static_cast<double>(units) * rule.unit * (rule.rotary ? deg_per_rad : 1e3);
    std::string t = fixed_text(value, 4);
    while (t.back() == '0') t.pop_back();
    if (t.back() == '.') t.pop_back();
    return t;
  }
  std::string step_name() const { return rule.rotary ? "step_deg" : "step_mm"; }
  Error too_many(std::int64_t step) const {
    const std::string of = rule.rotary ? " deg" : " mm";
    return {"axis " + rule.axis + ": a step of " + text(step) + of + " from " +
            text(std::min(from, origin)) + " to " + text(std::max(to, origin)) + of + " needs " +
            std::to_string(points(step)) + " points, the control takes " +
            std::to_string(rule.most) + ": set " + step_name() + " = " +
            text(smallest_that_fits()) + " or more"};
  }
};

Expected<std::int64_t> wished_step(const Plan& plan) {
  const GridRule& rule = plan.rule;
  const std::int64_t step = whole(rule.step, rule.unit);
  if (step < 1 || std::fabs(rule.step / rule.unit - static_cast<double>(step)) > 1e-3)
    return fail("axis " + rule.axis + ": " + plan.step_name() + " must be a whole multiple of " +
                plan.text(1));
  if (plan.points(step) > static_cast<std::int64_t>(rule.most)) return fail(plan.too_many(step));
  if (!plan.fits(step))
    return fail("axis " + rule.axis + ": " + plan.step_name() + " = " + plan.text(step) +
                (rule.turn ? " does not divide the turn: set "
                           : " is not a power of two of " + plan.text(1) + ": set ") +
                plan.step_name() + " = " + plan.text(plan.allowed(step)));
  return step;
}

Expected<std::int64_t> interpolating_step(const Plan& plan, std::int64_t smallest_gap,
                                          std::int64_t mean_gap) {
  const GridRule& rule = plan.rule;
  const std::int64_t fine = std::max(smallest_gap, mean_gap / 2) / 2;
  std::int64_t step = plan.allowed(std::max<std::int64_t>(1, rounded_down(fine)));
  if (plan.fits(step)) return step;
  step = plan.smallest_that_fits();
  if (plan.fits(step) && step <= (rule.power_of_two ? 2 * mean_gap : mean_gap)) return step;
  return fail(plan.too_many(std::min(step, plan.allowed(std::max<std::int64_t>(1, mean_gap)))));
}

// Targets are even within 10 units of the grid, because they were rounded; the step is rounded up
// so that there are as many points as targets. 0 if they are not even, if the grid does not begin
// at the first one, or for a turn or powers of two.
std::int64_t even_step(const Plan& plan, const std::vector<std::int64_t>& knots) {
  const auto gaps = static_cast<std::int64_t>(knots.size() - 1);
  const std::int64_t span = knots.back() - knots.front();
  if (plan.rule.turn || plan.rule.power_of_two || plan.origin != knots.front()) return 0;
  for (std::int64_t i = 0; i <= gaps; ++i)
    if (std::abs((knots[static_cast<std::size_t>(i)] - knots.front()) * gaps - i * span) >
        10 * gaps)
      return 0;
  return ceil_div(span, gaps);
}

Expected<std::int64_t> chosen_step(const Plan& plan, const std::vector<std::int64_t>& knots) {
  std::int64_t common = plan.rule.turn ? plan.full : 0;
  std::int64_t smallest_gap = std::numeric_limits<std::int64_t>::max();
  for (std::size_t i = 0; i < knots.size(); ++i) {
    common = std::gcd(common, knots[i] - plan.origin);
    if (i > 0) smallest_gap = std::min(smallest_gap, knots[i] - knots[i - 1]);
  }
  if (const std::int64_t even = even_step(plan, knots); even > 0) {
    if (plan.fits(even)) return even;
    return fail(plan.too_many(even));
  }
  const std::int64_t mean_gap =
      (knots.back() - knots.front()) / static_cast<std::int64_t>(knots.size() - 1);
  if (common > 0 && common >= mean_gap / 8 && plan.fits(common)) return common;
  if (common > 0 && common == mean_gap && !plan.rule.power_of_two)
    return fail(plan.too_many(common));
  return interpolating_step(plan, smallest_gap, mean_gap);
}

}  // namespace

double ErrorCurve::mean_reversal() const {
  if (!bidirectional()) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < position.size(); ++i) sum += plus[i] - minus[i];
  return sum / static_cast<double>(position.size());
}

double ErrorCurve::at(const std::vector<double>& position, const std::vector<double>& value,
                      double x) {
  if (position.empty()) return nan;
  if (x <= position.front()) return value.front();
  if (x >= position.back()) return value.back();
  if (!(x > position.front())) return nan;
  const auto above = static_cast<std::size_t>(
      std::upper_bound(position.begin(), position.end(), x) - position.begin());
  const double t = (x - position[above - 1]) / (position[above] - position[above - 1]);
  return value[above - 1] + t * (value[above] - value[above - 1]);
}

ErrorCurve error_curve(const AxisTest& test) {
  ErrorCurve c;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    const bool up = !test.plus(i).empty(), down = !test.minus(i).empty();
    if ((!up && !down) || (test.bidirectional() && !(up && down))) {
      ++c.left_out;
      continue;
    }
    c.position.push_back(test.targets[i]);
    if (up) c.plus.push_back(mean_of(test.plus(i)));
    if (down) c.minus.push_back(mean_of(test.minus(i)));
    c.mean.push_back(up && down ? (c.plus.back() + c.minus.back()) / 2.0
                                : (up ? c.plus.back() : c.minus.back()));
  }
  return c;
}

std::optional<ErrorCurve> closed_turn(const ErrorCurve& curve) {
  const std::size_t n = curve.position.size();
  constexpr double same = 1e-9;  // rad; closer positions are the same
  if (n < 3) return std::nullopt;
  const double span = curve.position.back() - curve.position.front();
  double largest_gap = 0.0;
  for (std::size_t i = 1; i < n; ++i)
    largest_gap = std::max(largest_gap, curve.position[i] - curve.position[i - 1]);
  if (!(span <= full_turn + same) || full_turn - span > 1.5 * largest_gap) return std::nullopt;

  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < n; ++i) {
    double x = std::fmod(curve.position[i], full_turn);
    if (x < -same) x += full_turn;
    if (x > full_turn - same || x < same) x = 0.0;
    order.emplace_back(x, i);
  }
  std::sort(order.begin(), order.end());
  // If 0 was not measured, interpolate its value across the end of the turn.
  const auto folded = [&](const std::vector<double>& value, std::vector<double>& position) {
    std::vector<double> x, y;
    for (std::size_t k = 0; k < n;) {
      double sum = 0.0;
      const std::size_t start = k;
      for (; k < n && order[k].first - order[start].first < same; ++k)
        sum += value[order[k].second];
      x.push_back(order[start].first);
      y.push_back(sum / static_cast<double>(k - start));
    }
    if (x.front() != 0.0) {
      const double t = (full_turn - x.back()) / (full_turn - x.back() + x.front());
      y.insert(y.begin(), y.back() + t * (y.front() - y.back()));
      x.insert(x.begin(), 0.0);
    }
    x.push_back(full_turn);
    y.push_back(y.front());
    position = x;
    return y;
  };
  ErrorCurve out;
  out.left_out = curve.left_out;
  out.mean = folded(curve.mean, out.position);
  if (!curve.plus.empty()) out.plus = folded(curve.plus, out.position);
  if (!curve.minus.empty()) out.minus = folded(curve.minus, out.position);
  return out;
}

Expected<Grid> choose_grid(const std::vector<double>& position, const GridRule& rule) {
  if (position.size() < 2)
    return fail("axis " + rule.axis + ": a table needs at least 2 targets, found " +
                std::to_string(position.size()));
  if (rule.most < 2) return fail("axis " + rule.axis + ": a table needs at least 2 points");
  Plan plan{rule, 0, whole(position.back(), rule.unit), 0, whole(full_turn, rule.unit)};
  plan.from = whole(rule.first.value_or(position.front()), rule.unit);
  plan.origin = rule.anchor ? whole(*rule.anchor, rule.unit) : plan.from;
  if (plan.to <= plan.from)
    return fail("axis " + rule.axis + ": the table would begin at " + plan.text(plan.from) +
                ", after the last target " + plan.text(plan.to));
  std::vector<std::int64_t> knots;
  for (double x : position) knots.push_back(whole(x, rule.unit));
  NONIO_TRY(const auto step, rule.step != 0.0 ? wished_step(plan) : chosen_step(plan, knots));
  Grid grid;
  grid.step = static_cast<double>(step) * rule.unit;
  grid.first = static_cast<double>(plan.origin + plan.low(step) * step) * rule.unit;
  grid.points = static_cast<std::size_t>(plan.points(step));
  return grid;
}

std::vector<std::int64_t> quantised(std::span<const double> value, double unit) {
  std::vector<std::int64_t> out;
  for (double v : value) out.push_back(std::llround(rounded_by_digits(v / unit)));
  return out;
}

std::vector<double> rounded(std::vector<double> value, double unit) {
  const auto steps = quantised(value, unit);
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = static_cast<double>(steps[i]) * unit;
  return value;
}

std::vector<std::int64_t> increments(std::span<const std::int64_t> absolute) {
  std::vector<std::int64_t> out;
  for (std::size_t i = 1; i < absolute.size(); ++i) out.push_back(absolute[i] - absolute[i - 1]);
  return out;
}

double MeanDeviations::E() const {
  std::vector<double> all = plus;
  all.insert(all.end(), minus.begin(), minus.end());
  return range(all);
}

double MeanDeviations::M() const {
  std::vector<double> mean;
  for (std::size_t i = 0; i < std::min(plus.size(), minus.size()); ++i)
    mean.push_back((plus[i] + minus[i]) / 2.0);
  return range(mean);
}

double MeanDeviations::B() const {
  std::vector<double> size;
  for (std::size_t i = 0; i < std::min(plus.size(), minus.size()); ++i)
    size.push_back(std::fabs(plus[i] - minus[i]));
  return size.empty() || !all_finite(size) ? nan : *std::max_element(size.begin(), size.end());
}

MeanDeviations before(const ErrorCurve& curve) { return {curve.plus, curve.minus}; }

MeanDeviations after(const ErrorCurve& curve, const Correction& correction) {
  MeanDeviations left;
  const auto loaded = [&](const std::vector<double>& e, int direction) {
    std::vector<double> out;
    for (std::size_t i = 0; i < e.size(); ++i) {
      const double c = correction(curve.position[i], direction);
      out.push_back(c + ErrorCurve::at(curve.position, e, curve.position[i] + c));
    }
    return out;
  };
  left.plus = loaded(curve.plus, +1);
  left.minus = loaded(curve.minus, -1);
  return left;
}

double reversal_uncertainty(const ErrorCurve& curve, const Correction& correction, double of_target,
                            double of_mean) {
  constexpr double last_digit = 1e-7;  // m or rad
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double x : curve.position) {
    const double removed = correction(x, 1) - correction(x, -1);
    low = std::min(low, removed), high = std::max(high, removed);
  }
  if (!curve.bidirectional() || !(std::max(std::fabs(low), std::fabs(high)) > last_digit))
    return 0.0;
  return high - low > last_digit ? of_target : of_mean;
}

}  // namespace nonio::math
