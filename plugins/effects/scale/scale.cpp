// SPDX-License-Identifier: Apache-2.0
// deviation = a p; p: position from the middle of the measured stretch, m or rad; a: m/m or
// rad/rad. Source: EFFECTS catalogue of docs/formulas.md.
#include <algorithm>

#include "nonio/sdk/plugin.h"

using namespace nonio;

static const Observations::AxisColumn* column_of(const Observations& o, const Axis& axis) {
  for (const auto& column : o.axes)
    if (column.axis == axis.name && !column.position.empty()) return &column;
  return nullptr;
}

static bool applies(const Observations& o, const Axis& axis) {
  return column_of(o, axis) != nullptr;
}

static Expected<std::vector<std::vector<double>>> columns(const Observations& o, const Axis& axis,
                                                          const std::vector<double>&) {
  const auto* column = column_of(o, axis);
  if (column == nullptr) return fail("scale:" + axis.name + ": the readings do not move this axis");
  const auto [low, high] = std::minmax_element(column->position.begin(), column->position.end());
  const double middle = (*low + *high) / 2.0;
  std::vector<double> p(column->position);
  for (double& x : p) x -= middle;
  return std::vector<std::vector<double>>{std::move(p)};
}

NONIO_PLUGIN(registry) {
  registry.add(
      Effect{{"scale",
              "1.0.0",
              "Deviation proportional to the travel: pitch or scale error, expansion",
              {}},
             {{"a", "slope of the deviation over the travel", Quantity::deviation_per_length}},
             {},
             applies,
             columns});
}
