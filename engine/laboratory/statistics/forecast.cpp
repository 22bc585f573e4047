// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/forecast.h"

#include <algorithm>
#include <cmath>

#include "laboratory/statistics/gls.h"

namespace nonio::statistics {
namespace {

constexpr double act_beyond = 0.5;
constexpr double one_sided = 1.6448536269514722;  // quantile of the one-sided 95 % bound
// Largest extrapolation, as a fraction of the time span.
constexpr double farthest = 0.5;
constexpr double years_ahead = 20.0;

struct State {
  double value = 0.0, u = 0.0;
};

State state_at(const Series& s, const Trend& t, double time) {
  const std::size_t p = t.coefficients.size();
  std::vector<double> x(p, 1.0);
  if (t.drifts) x.back() = time - s.points.front().time;
  State out;
  double variance = t.walk * (time - s.points.back().time);
  for (std::size_t i = 0; i < p; ++i) {
    out.value += x[i] * t.coefficients[i];
    for (std::size_t j = 0; j < p; ++j) variance += x[i] * x[j] * t.covariance[i * p + j];
  }
  out.u = std::sqrt(std::max(variance, 0.0));
  return out;
}

/// Returns P(|state| + more > limit) for normally distributed state and `more`.
double p_beyond(double value, double u_value, double limit, const Beyond& more) {
  const double u = std::hypot(u_value, more.u), left = limit - more.value;
  if (!(u > 0.0)) return std::fabs(value) > left ? 1.0 : 0.0;
  return std::min(1.0, normal_upper((left - value) / u) + normal_upper((left + value) / u));
}

bool bound_meets(const Series& s, const Trend& t, double time, double limit, const Beyond& more) {
  const State at = state_at(s, t, time);
  return std::fabs(at.value) + more.value + one_sided * std::hypot(at.u, more.u) >= limit;
}

std::optional<double> leaving(const Series& s, const Trend& t, double limit, const Beyond& more) {
  double low = s.points.back().time, high = low + years_ahead;
  if (bound_meets(s, t, low, limit, more)) return low;
  if (!bound_meets(s, t, high, limit, more)) return std::nullopt;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2.0;
    (bound_meets(s, t, middle, limit, more) ? high : low) = middle;
  }
  return high;
}

}  // namespace

Forecast forecast(const Series& s, const Trend& t, double time, std::optional<double> limit,
                  std::optional<double> u_new, Beyond more) {
  Forecast out;
  out.time = time;
  if (t.coefficients.empty() || !std::isfinite(time)) return out;
  const State at = state_at(s, t, time);
  out.value = at.value, out.u = at.u;
  out.u_reading = std::hypot(at.u, s.excess * u_new.value_or(s.points.back().u));
  const double span = s.points.back().time - s.points.front().time;
  const bool near = time <= s.points.back().time + farthest * span;
  if (!limit) {
    if (s.points.size() >= 3 && near) out.answer = Answer::keep;
    return out;
  }
  out.p_out = p_beyond(at.value, at.u, *limit, more);
  out.p_read_out = p_beyond(at.value, out.u_reading, *limit, more);
  out.leaves = leaving(s, t, *limit, more);
  if (std::fabs(s.points.back().value) + more.value > *limit)
    out.answer = Answer::act;
  else if (s.points.size() >= 3 && near)
    out.answer = out.p_out < keep_below    ? Answer::keep
                 : out.p_out <= act_beyond ? Answer::watch
                                           : Answer::act;
  return out;
}

}  // namespace nonio::statistics
