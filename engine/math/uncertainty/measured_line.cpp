// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/measured_line.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nonio::math {

bool MeasuredLine::has(int direction) const {
  return std::all_of(stops.begin(), stops.end(), [&](const Stop& p) {
    return (p.n_plus > 0 || direction < 0) && (p.n_minus > 0 || direction > 0);
  });
}

std::optional<int> MeasuredLine::direction() const {
  for (const int d : {0, 1, -1})
    if (has(d)) return d;
  return std::nullopt;
}

double MeasuredLine::u_mean(int direction) const {
  std::size_t plus = std::numeric_limits<std::size_t>::max(), minus = plus;
  for (const Stop& p : stops) plus = std::min(plus, p.n_plus), minus = std::min(minus, p.n_minus);
  if (direction != 0) {
    const std::size_t n = direction > 0 ? plus : minus;
    return n == 0 ? 0.0 : s / std::sqrt(static_cast<double>(n));
  }
  if (plus == 0 || minus == 0) return 0.0;
  return s / 2.0 * std::sqrt(1.0 / static_cast<double>(plus) + 1.0 / static_cast<double>(minus));
}

double MeasuredLine::mean_reversal() const {
  double sum = 0.0;
  for (const Stop& p : stops) sum += p.reversal();
  return sum / static_cast<double>(stops.size());
}

std::vector<BudgetLine::Visit> MeasuredLine::visits(int direction) const {
  std::vector<BudgetLine::Visit> out;
  for (std::size_t i = zeroed ? 1 : 0; i < stops.size(); ++i) {
    const Stop& p = stops[i];
    const double part = direction == 0 ? 0.5 : 1.0;
    if (direction >= 0)
      for (const double t : p.at_plus)
        out.push_back({t, i, part / static_cast<double>(p.at_plus.size())});
    if (direction <= 0)
      for (const double t : p.at_minus)
        out.push_back({t, i, part / static_cast<double>(p.at_minus.size())});
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return out;
}

std::size_t MeasuredLine::find(double position) const {
  for (std::size_t i = 0; i < stops.size(); ++i)
    if (std::fabs(stops[i].position - position) <= same_stop) return i;
  return stops.size();
}

namespace {

/// Returns the sum of squares, about the mean, of a random walk with variance 1 at these times.
double squares_of_walk(const std::vector<double>& times) {
  double sum = 0.0, common = 0.0;
  for (const double t : times) {
    sum += t;
    for (const double other : times) common += std::min(t, other);
  }
  return times.empty() ? 0.0 : sum - common / static_cast<double>(times.size());
}

}  // namespace

MeasuredLine measured_line(const Observations& o, std::size_t column) {
  const auto& axis = o.axes[column];
  std::vector<std::size_t> order(o.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return axis.position[a] < axis.position[b];
  });
  const std::vector<double> times = reading_times(o);
  MeasuredLine line;
  double squares = 0.0;
  std::size_t dof = 0;
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    MeasuredLine::Stop stop;
    stop.position = axis.position[order[begin]];
    if (o.axes.size() > 1) stop.across = o.axes[1 - column].position[order[begin]];
    if (order[begin] < o.source_line.size()) stop.source_line = o.source_line[order[begin]];
    bool zero = true;
    for (; end < order.size() && axis.position[order[end]] - stop.position <= same_stop; ++end) {
      const bool plus = axis.approach.empty() || axis.approach[order[end]] > 0;
      (plus ? stop.plus : stop.minus) += o.deviation[order[end]];
      ++(plus ? stop.n_plus : stop.n_minus);
      (plus ? stop.at_plus : stop.at_minus).push_back(times[order[end]]);
      zero = zero && o.deviation[order[end]] == 0.0;
    }
    if (stop.n_plus > 0) stop.plus /= static_cast<double>(stop.n_plus);
    if (stop.n_minus > 0) stop.minus /= static_cast<double>(stop.n_minus);
    if (begin == 0) line.zeroed = zero;
    if (begin > 0 || !zero) {  // a zero by definition has no scatter
      for (std::size_t k = begin; k < end; ++k) {
        const bool plus = axis.approach.empty() || axis.approach[order[k]] > 0;
        const double e = o.deviation[order[k]] - (plus ? stop.plus : stop.minus);
        squares += e * e;
      }
      line.walk_seen += squares_of_walk(stop.at_plus) + squares_of_walk(stop.at_minus);
      dof += std::max<std::size_t>(stop.n_plus, 1) - 1 + std::max<std::size_t>(stop.n_minus, 1) - 1;
    }
    line.stops.push_back(stop);
    begin = end;
  }
  line.dof = dof;
  if (dof > 0) line.s = std::sqrt(squares / static_cast<double>(dof));
  if (dof > 0) line.walk_seen /= static_cast<double>(dof);
  return line;
}

}  // namespace nonio::math
