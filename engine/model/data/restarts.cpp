// SPDX-License-Identifier: Apache-2.0
#include "restarts.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/thermal.h"

namespace nonio::model {

namespace {

// docs/dev/constants.md, M58.
constexpr double longer_than_interval = 10.0, usual_gap = 900.0, share_of_test = 0.01;
constexpr double shortest_segment = 0.1;   // median duration of segments / median gap
constexpr double change_of_source = 0.25;  // of the range of a speed or load

double median(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

std::vector<double> differences(const std::vector<double>& x) {
  std::vector<double> out;
  for (std::size_t i = 1; i < x.size(); ++i) out.push_back(x[i] - x[i - 1]);
  return out;
}

/// None if the readings were taken in bursts, which share a zero.
std::vector<std::size_t> rows_after_gaps(const std::vector<double>& time) {
  const std::vector<double> interval = differences(time);
  const double least = std::max(longer_than_interval * median(interval),
                                std::min(usual_gap, share_of_test * (time.back() - time.front())));
  std::vector<std::size_t> rows;
  std::vector<double> gaps, segments;
  double begin = time.front();
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(interval[i - 1] > least)) continue;
    rows.push_back(i);
    gaps.push_back(interval[i - 1]);
    segments.push_back(time[i - 1] - begin);
    begin = time[i];
  }
  segments.push_back(time.back() - begin);
  if (!rows.empty() && median(segments) < shortest_segment * median(gaps)) rows.clear();
  return rows;
}

/// Whether a speed or a load changes at that time, which can move a machine at once.
bool source_changes(const Observations& o, double from, double to) {
  for (const auto& c : o.channels) {
    if (c.is_temperature() || c.value.empty()) continue;
    const auto at = [&](double t) {
      const auto after = std::upper_bound(c.time.begin(), c.time.end(), t);
      return std::max<std::ptrdiff_t>(after - c.time.begin() - 1, 0);
    };
    const auto [low, high] = std::minmax_element(c.value.begin(), c.value.end());
    const auto [least, most] =
        std::minmax_element(c.value.begin() + at(from), c.value.begin() + at(to) + 1);
    if (*most - *least > change_of_source * (*high - *low)) return true;
  }
  return false;
}

}  // namespace

std::vector<Restart> restarts_of(const Part& part) {
  const Observations& o = part.table;
  if (o.size() < 3) return {};
  std::vector<Restart> out;
  const auto moves_at_once = [&](double from, double to) { return source_changes(o, from, to); };
  for (const math::Jump& jump : math::jumps_of({o.time, o.deviation}, moves_at_once))
    out.push_back({o.time[jump.before], o.time[jump.before + 1], jump.size, part.displacement});
  for (const std::size_t row : rows_after_gaps(o.time)) {
    std::erase_if(out, [&](const Restart& jump) { return jump.to == o.time[row]; });
    out.push_back({o.time[row - 1], o.time[row]});
  }
  return out;
}

void put_restarts(Part& part, std::vector<Restart> restarts) {
  std::stable_sort(restarts.begin(), restarts.end(),
                   [](const Restart& a, const Restart& b) { return a.to < b.to; });
  restarts.erase(std::unique(restarts.begin(), restarts.end(),
                             [](const Restart& a, const Restart& b) { return a.to == b.to; }),
                 restarts.end());
  Observations& o = part.table;
  o.lines.resize(restarts.size() + 1, o.lines.front());
  auto next = restarts.begin();
  for (std::size_t i = 0; i < o.size() && !restarts.empty(); ++i) {
    while (next != restarts.end() && next->to <= o.time[i]) ++next;
    o.line.push_back(static_cast<std::uint32_t>(next - restarts.begin()));
  }
  part.restarts = std::move(restarts);
}

}  // namespace nonio::model
