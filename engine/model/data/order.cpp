// SPDX-License-Identifier: Apache-2.0
#include "order.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace nonio::model {

namespace {

using Rows = std::vector<std::uint32_t>;

/// One run in one direction, its rows as listed.
using Passes = std::map<std::pair<std::uint32_t, std::int8_t>, Rows>;

Passes passes_of(const Observations& o) {
  Passes passes;
  for (std::uint32_t i = 0; i < o.size(); ++i)
    passes[{o.run_of(i), o.axes.front().approach[i]}].push_back(i);
  return passes;
}

/// All readings of one direction stand before all of the other, and there are several runs.
bool grouped(const Passes& passes) {
  std::map<std::int8_t, Rows> side;
  std::map<std::int8_t, int> runs;
  for (const auto& [pass, rows] : passes) {
    auto& all = side[pass.second];
    all.insert(all.end(), rows.begin(), rows.end());
    ++runs[pass.second];
  }
  if (side.size() != 2 || runs.begin()->second < 2) return false;
  const auto ends = [](const Rows& rows) { return std::minmax_element(rows.begin(), rows.end()); };
  const auto [low, high] = ends(side.begin()->second);
  const auto [other_low, other_high] = ends(side.rbegin()->second);
  return *high < *other_low || *other_high < *low;
}

/// Some pass is listed from its end to its begin.
bool against_its_direction(const Observations& o, const Passes& passes) {
  const auto& position = o.axes.front().position;
  return std::any_of(passes.begin(), passes.end(), [&](const auto& entry) {
    const auto& [pass, rows] = entry;
    if (pass.second == 0 || rows.size() < 3) return false;
    for (std::size_t k = 1; k < rows.size(); ++k)
      if (!((position[rows[k]] - position[rows[k - 1]]) * pass.second < 0.0)) return false;
    return true;
  });
}

/// Run by run, the direction that is listed first first, each pass along its direction. Runs are
/// counted in each direction: the second group of a file may go on counting.
Rows pendulum(const Observations& o, const Passes& passes) {
  const auto& axis = o.axes.front();
  std::map<std::int8_t, std::uint32_t> count;
  std::map<std::pair<std::uint32_t, std::int8_t>, std::uint32_t> turn;
  for (const auto& [pass, rows] : passes) turn[pass] = count[pass.second]++;
  const std::int8_t first = axis.approach.front();
  Rows rows(o.size());
  std::iota(rows.begin(), rows.end(), 0U);
  std::stable_sort(rows.begin(), rows.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::int8_t way = axis.approach[a], other = axis.approach[b];
    const std::uint32_t of_a = turn.at({o.run_of(a), way}), of_b = turn.at({o.run_of(b), other});
    if (of_a != of_b) return of_a < of_b;
    if (way != other) return way == first;
    return axis.position[a] * way < axis.position[b] * way;
  });
  return rows;
}

}  // namespace

Order order_of(const Observations& o, const std::string& said) {
  Order out;
  out.rows.resize(o.size());
  std::iota(out.rows.begin(), out.rows.end(), 0U);
  if (o.size() == 0) return out;
  if (o.time.size() == o.size() &&
      std::all_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); })) {
    std::stable_sort(out.rows.begin(), out.rows.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return o.time[a] < o.time[b]; });
    return out;
  }
  out.known = said != "unknown";
  if (said == "as-listed" || !out.known) return out;
  const Passes passes = passes_of(o);
  out.assumed = said.empty() && (grouped(passes) || against_its_direction(o, passes));
  if (out.assumed || said == "pendulum") out.rows = pendulum(o, passes);
  return out;
}

}  // namespace nonio::model
