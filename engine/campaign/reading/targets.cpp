// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/targets.h"

#include <algorithm>
#include <map>

namespace nonio::reading {
namespace {

void keep_distinct(std::vector<double>& x) {
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
}

/// Memory follows the number of positions, not of readings: thinned whenever it has doubled.
std::vector<double> distinct(const std::vector<double>& positions) {
  std::vector<double> out;
  std::size_t limit = 1U << 16U;
  for (const double x : positions) {
    if (!out.empty() && out.back() == x) continue;
    out.push_back(x);
    if (out.size() < limit) continue;
    keep_distinct(out);
    limit = std::max(limit, 2 * out.size());
  }
  keep_distinct(out);
  return out;
}

/// Every position that has a neighbour as near as that, and how many readings it has. A group does
/// not reach further than the tolerance from its first position.
std::vector<std::map<double, std::size_t>> groups_of(const std::vector<double>& x) {
  std::vector<std::map<double, std::size_t>> groups;
  for (std::size_t i = 0; i < x.size();) {
    std::size_t end = i + 1;
    while (end < x.size() && x[end] - x[i] <= grid_tolerance) ++end;
    if (end - i > 1) {
      auto& group = groups.emplace_back();
      for (std::size_t k = i; k < end; ++k) group[x[k]] = 0;
    }
    i = end;
  }
  return groups;
}

std::size_t join(std::vector<double>& positions) {
  auto groups = groups_of(distinct(positions));
  if (groups.empty()) return 0;
  const auto group_of = [&](double x) -> std::map<double, std::size_t>* {
    const auto after = std::upper_bound(
        groups.begin(), groups.end(), x,
        [](double value, const auto& group) { return value < group.begin()->first; });
    if (after == groups.begin()) return nullptr;
    const auto group = after - 1;
    return group->count(x) != 0 ? &*group : nullptr;
  };
  for (const double x : positions)
    if (auto* group = group_of(x)) ++(*group)[x];
  std::map<const std::map<double, std::size_t>*, double> common;
  for (const auto& group : groups)
    common[&group] = std::max_element(group.begin(), group.end(), [](const auto& a, const auto& b) {
                       return a.second < b.second;
                     })->first;
  std::size_t moved = 0;
  for (double& x : positions)
    if (const auto* group = group_of(x)) {
      moved += x != common[group] ? 1 : 0;
      x = common[group];
    }
  return moved;
}

}  // namespace

std::size_t join_targets(Observations& o) {
  std::size_t moved = 0;
  for (auto& axis : o.axes) moved += join(axis.position);
  return moved;
}

}  // namespace nonio::reading
