// SPDX-License-Identifier: Apache-2.0
#include "thin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "design.h"

namespace nonio::model {

namespace {

// docs/dev/constants.md, M22: most groups of runs, and smallest limit for those of positions.
constexpr std::size_t most_runs = 20, least_positions = 25;

/// Joins adjacent distinct values into at most `most` groups.
std::vector<std::size_t> grouped(const std::vector<double>& values, std::size_t most) {
  std::vector<double> distinct = values;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const std::size_t together = (distinct.size() + most - 1) / most;
  std::vector<std::size_t> out;
  out.reserve(values.size());
  for (const double v : values)
    out.push_back(static_cast<std::size_t>(std::lower_bound(distinct.begin(), distinct.end(), v) -
                                           distinct.begin()) /
                  together);
  return out;
}

}  // namespace

bool can_be_thinned(const Observations& o) {
  return o.axes.size() == 1 && o.axes.front().approach.size() == o.size();
}

Part thinned(const Part& part, const std::vector<double>& weight) {
  Part out = part;
  out.table = thinned(part.table, weight);
  out.along = out.table.axes.front().position;
  out.way = out.table.axes.front().approach;
  out.measurement.clear();
  out.row.clear();
  return out;
}

Observations thinned(const Observations& o, const std::vector<double>& weight) {
  if (!can_be_thinned(o)) return o;
  const auto& axis = o.axes.front();
  std::vector<double> runs(o.run.begin(), o.run.end());
  runs.resize(o.size(), 1.0);
  // Number of means on each side of each line that fit into `thin_beyond`.
  const std::size_t means = thin_beyond / 2 / std::max<std::size_t>(o.lines.size(), 1);
  const auto run_group =
      grouped(runs, std::clamp<std::size_t>(means / least_positions, 2, most_runs));
  const std::size_t run_groups = *std::max_element(run_group.begin(), run_group.end()) + 1;
  const auto place_group = grouped(axis.position, std::max(least_positions, means / run_groups));
  Observations out;
  out.measurement = o.measurement;
  out.angular = o.angular;
  out.lines = o.lines;
  out.axes = {{axis.axis, axis.rotary, {}, {}}};
  std::map<std::tuple<std::uint32_t, std::size_t, std::int8_t, std::size_t>, std::size_t> row_of;
  std::vector<double> count;
  std::vector<double> squared_u, mean_squared_u;
  for (const double u : stated_u(o)) squared_u.push_back(u * u);
  const auto mean_into = [&](std::vector<double>& to, const std::vector<double>& from,
                             std::size_t i, std::size_t row) {
    if (from.empty()) return;
    if (row == to.size()) to.push_back(0.0);
    to[row] += (from[i] - to[row]) / count[row];
  };
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!weight.empty() && !(weight[i] > 0.0)) continue;
    const std::size_t run = run_group[i];
    const std::uint32_t line = o.line.empty() ? 0 : o.line[i];
    const auto [at, fresh] =
        row_of.try_emplace({line, run, axis.approach[i], place_group[i]}, count.size());
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
    mean_into(out.air, o.air, i, row);
    mean_into(out.pressure, o.pressure, i, row);
    mean_into(out.humidity, o.humidity, i, row);
    mean_into(mean_squared_u, squared_u, i, row);
  }
  // Rows of one group of targets get one common position, otherwise they would not be repeats.
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
  for (std::size_t row = 0; row < count.size(); ++row)
    out.u.push_back(
        std::sqrt((mean_squared_u.empty() ? 1.0 : mean_squared_u[row]) * mean_count / count[row]));
  return out;
}

}  // namespace nonio::model
