// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/along.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/budget.h"

namespace nonio::math {

std::vector<std::string> moving_axes(const Measurement& m) {
  constexpr double same_end = 1e-4;  // m, tolerance for equal ends
  std::vector<std::string> axes;
  for (const auto& [axis, from] : m.from)
    if (const auto to = m.to.find(axis);
        to != m.to.end() && std::fabs(to->second - from) > same_end)
      axes.push_back(axis);
  std::sort(axes.begin(), axes.end());
  return axes;
}

std::vector<double> direction_along(const Measurement& m) {
  std::vector<double> out;
  double squares = 0.0;
  for (const std::string& axis : moving_axes(m)) {
    out.push_back(m.to.at(axis) - m.from.at(axis));
    squares += out.back() * out.back();
  }
  for (double& share : out) share /= std::sqrt(squares);
  return out;
}

Observations along_diagonal(const Observations& o, const Measurement& m) {
  Observations out = o;
  Observations::AxisColumn column{m.id, false, std::vector<double>(o.size(), 0.0), {}};
  const std::vector<std::string> axes = moving_axes(m);
  const std::vector<double> direction = direction_along(m);
  for (const auto& a : o.axes)
    for (std::size_t k = 0; k < axes.size(); ++k) {
      if (a.axis != axes[k]) continue;
      for (std::size_t i = 0; i < o.size(); ++i)
        column.position[i] += (a.position[i] - m.from.at(a.axis)) * direction[k];
      if (!column.approach.empty()) continue;
      for (const auto approach : a.approach)
        column.approach.push_back(
            static_cast<std::int8_t>(direction[k] > 0.0 ? approach : -approach));
    }
  out.axes = {std::move(column)};
  return out;
}

BudgetOrGap budget_along(const Campaign& campaign, const Environment& environment,
                         const Measurement& m, const AxisTest& test) {
  BudgetLine line;
  put_expansion(line, campaign, moving_axes(m), direction_along(m));
  Campaign with = campaign;
  with.machine.axes.push_back(Axis{.name = m.id, .expansion = line.expansion});
  BudgetOrGap out = uncertainty_budget(with, environment, m.id, test);
  for (std::string& key : out.missing)
    if (key.find("machine.axes.") == 0) key = line.expansion_keys;
  return out;
}

}  // namespace nonio::math
