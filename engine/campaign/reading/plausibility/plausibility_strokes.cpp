// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/plausibility/plausibility_strokes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace nonio::reading {
namespace {

std::vector<std::size_t> order_in_file(const Observations& o) {
  std::vector<std::size_t> order(o.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  if (!o.source_line.empty())
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return o.source_line[a] < o.source_line[b];
    });
  return order;
}

std::vector<std::size_t> order_in_time(const Observations& o) {
  auto order = order_in_file(o);
  const auto known = [](double t) { return std::isfinite(t); };
  if (!o.time.empty() && std::all_of(o.time.begin(), o.time.end(), known))
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return o.time[a] < o.time[b]; });
  return order;
}

int sense_of_targets(const std::vector<double>& targets) {
  bool rises = targets.size() > 1, falls = rises;
  for (std::size_t i = 1; i < targets.size(); ++i) {
    rises &= targets[i] > targets[i - 1];
    falls &= targets[i] < targets[i - 1];
  }
  return rises ? 1 : falls ? -1 : 0;
}

void count_backwards(Stroke& s) {
  std::size_t rises = 0, falls = 0;
  for (std::size_t i = 1; i < s.target.size(); ++i)
    ++(s.target[i] > s.target[i - 1] ? rises : falls);
  s.backwards = std::min(rises, falls);
  for (std::size_t i = s.target.size(); i-- > 1;)
    if ((s.target[i] > s.target[i - 1]) == (rises < falls))
      s.turns_at = std::min(s.target[i], s.target[i - 1]);
}

std::vector<Stroke> in_order(const Observations& o, const std::vector<std::size_t>& order) {
  std::map<std::tuple<std::uint32_t, std::uint32_t, int>, std::size_t> known;
  std::vector<Stroke> strokes;
  const auto& axis = o.axes.front();
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::size_t i = order[at];
    const int direction = axis.approach.empty() ? 0 : axis.approach[i];
    const auto [found, is_new] =
        known.try_emplace({o.line_of(i), o.run_of(i), direction}, strokes.size());
    if (is_new) {
      Stroke& fresh = strokes.emplace_back();
      fresh.line = o.line_of(i);
      fresh.run = o.run_of(i);
      fresh.direction = direction;
      fresh.first = at;
    }
    Stroke& s = strokes[found->second];
    s.last = at;
    s.target.push_back(axis.position[i]);
    s.deviation.push_back(o.deviation[i]);
  }
  for (Stroke& s : strokes) s.alone = s.last - s.first + 1 == s.target.size();
  return strokes;
}

}  // namespace

namespace {

std::vector<Stroke> strokes_of(const Observations& o) {
  if (o.axes.empty() || o.axes.front().position.size() < o.size()) return {};
  auto strokes = in_order(o, order_in_time(o));
  std::map<std::tuple<std::uint32_t, std::uint32_t, int>, bool> alone;
  if (!o.time.empty())
    for (const Stroke& s : in_order(o, order_in_file(o)))
      alone[{s.line, s.run, s.direction}] = s.alone;
  for (Stroke& s : strokes) {
    s.alone_in_file = o.time.empty() ? s.alone : alone[{s.line, s.run, s.direction}];
    s.sense = sense_of_targets(s.target);
    count_backwards(s);
    s.as_taken = s.deviation;
    // Sorting by target finds copies in either direction.
    std::vector<std::pair<double, double>> rows;
    for (std::size_t i = 0; i < s.target.size(); ++i)
      rows.emplace_back(s.target[i], s.deviation[i]);
    std::stable_sort(rows.begin(), rows.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < rows.size(); ++i)
      s.target[i] = rows[i].first, s.deviation[i] = rows[i].second;
  }
  return strokes;
}

}  // namespace

std::string name_of(const Stroke& s) {
  std::string name = std::to_string(s.run);
  if (s.direction != 0) name += s.direction > 0 ? " +" : " -";
  return name;
}

namespace {

double step_of(const std::vector<Stroke>& strokes) {
  std::vector<double> all;
  for (const Stroke& s : strokes) all.insert(all.end(), s.deviation.begin(), s.deviation.end());
  std::sort(all.begin(), all.end());
  double step = 0.0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const double d = all[i] - all[i - 1];
    if (d > 1e-12 && (step == 0.0 || d < step)) step = d;
  }
  // With few readings, the number of decimals determines the resolution.
  constexpr double finest = 1e-10;
  for (double grid = 1e-6; grid > finest; grid /= 10.0)
    if (std::all_of(all.begin(), all.end(),
                    [&](double d) { return std::fabs(d / grid - std::round(d / grid)) < 1e-4; }))
      return step > 0.0 ? std::min(step, grid) : 0.0;
  return step;
}

}  // namespace

Passes passes_of(const Observations& o) {
  Passes passes{strokes_of(o)};
  passes.step = step_of(passes.strokes);
  return passes;
}

void take_line_out(const std::vector<double>& at, std::vector<double>& values) {
  const auto n = static_cast<double>(at.size());
  double t = 0.0, v = 0.0, tt = 0.0, tv = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) t += at[i] / n, v += values[i] / n;
  for (std::size_t i = 0; i < at.size(); ++i) {
    tt += (at[i] - t) * (at[i] - t);
    tv += (at[i] - t) * (values[i] - v);
  }
  for (std::size_t i = 0; i < at.size(); ++i)
    values[i] -= v + (tt > 0.0 ? tv / tt : 0.0) * (at[i] - t);
}

}  // namespace nonio::reading
