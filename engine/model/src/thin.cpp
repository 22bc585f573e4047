// SPDX-License-Identifier: Apache-2.0
#include "thin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace nonio::model {

namespace {

constexpr std::size_t most_runs = 20, most_positions = 100;

/// Ranks of values, joined so that at most so many groups are left.
std::map<double, std::size_t> groups(const std::vector<double>& values, std::size_t most) {
  std::map<double, std::size_t> rank;
  for (const double v : values) rank.try_emplace(v, 0);
  const std::size_t together = (rank.size() + most - 1) / most;
  std::size_t k = 0;
  for (auto& [value, group] : rank) group = k++ / together;
  return rank;
}

}  // namespace

Observations thinned(const Observations& o) {
  if (o.axes.size() != 1 || o.axes.front().approach.size() != o.size()) return o;
  const auto& axis = o.axes.front();
  const std::vector<double> runs(o.run.begin(), o.run.end());
  const auto run_group = groups(runs, most_runs);
  const auto place_group = groups(axis.position, most_positions);
  Observations out;
  out.measurement = o.measurement;
  out.angular = o.angular;
  out.lines = o.lines;
  out.axes = {{axis.axis, axis.rotary, {}, {}}};
  std::map<std::tuple<std::uint32_t, std::size_t, std::int8_t, std::size_t>, std::size_t> row_of;
  std::vector<double> count;
  const auto mean_into = [&](std::vector<double>& to, const std::vector<double>& from,
                             std::size_t i, std::size_t row) {
    if (from.empty()) return;
    if (row == to.size()) to.push_back(0.0);
    to[row] += (from[i] - to[row]) / count[row];
  };
  for (std::size_t i = 0; i < o.size(); ++i) {
    const std::size_t run = runs.empty() ? 0 : run_group.at(runs[i]);
    const std::uint32_t line = o.line.empty() ? 0 : o.line[i];
    const auto [at, fresh] = row_of.try_emplace(
        {line, run, axis.approach[i], place_group.at(axis.position[i])}, count.size());
    const std::size_t row = at->second;
    if (fresh) {
      count.push_back(0.0);
      out.axes.front().approach.push_back(axis.approach[i]);
      out.run.push_back(static_cast<std::uint32_t>(run + 1));
      if (!o.line.empty()) out.line.push_back(line);
      if (!o.source_line.empty()) out.source_line.push_back(o.source_line[i]);
    }
    count[row] += 1.0;
    mean_into(out.axes.front().position, axis.position, i, row);
    mean_into(out.deviation, o.deviation, i, row);
    mean_into(out.time, o.time, i, row);
    mean_into(out.material, o.material, i, row);
  }
  // Rows whose target is in one bin get one position, or they would not repeat each other.
  std::map<std::size_t, std::pair<double, double>> place;
  std::vector<std::size_t> group_of(count.size());
  for (const auto& [key, row] : row_of) {
    auto& [sum, n] = place[std::get<3>(key)];
    sum += out.axes.front().position[row] * count[row];
    n += count[row];
    group_of[row] = std::get<3>(key);
  }
  for (std::size_t row = 0; row < count.size(); ++row) {
    const auto& [sum, n] = place[group_of[row]];
    out.axes.front().position[row] = sum / n;
  }
  double mean_count = 0.0;
  for (const double c : count) mean_count += c / static_cast<double>(count.size());
  for (const double c : count) out.u.push_back(std::sqrt(mean_count / c));
  return out;
}

}  // namespace nonio::model
