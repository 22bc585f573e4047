// SPDX-License-Identifier: Apache-2.0
// deviation = b d/2; d: direction of approach, +1 or -1; b: m or rad, negative for lost motion.
#include "nonio/sdk/plugin.h"

using namespace nonio;

static const Observations::AxisColumn* column_of(const Observations& o, const Axis& axis) {
  for (const auto& column : o.axes)
    if (column.axis == axis.name && !column.approach.empty()) return &column;
  return nullptr;
}

static bool applies(const Observations& o, const Axis& axis) {
  return column_of(o, axis) != nullptr;
}

static Expected<std::vector<std::vector<double>>> columns(const Observations& o, const Axis& axis,
                                                          const std::vector<double>&) {
  const auto* column = column_of(o, axis);
  if (column == nullptr)
    return fail("backlash:" + axis.name + ": the readings do not say from where this axis came");
  std::vector<double> half;
  half.reserve(o.size());
  for (const std::int8_t d : column->approach) half.push_back(0.5 * d);
  return std::vector<std::vector<double>>{std::move(half)};
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{{"backlash",
                       "1.0.0",
                       "Constant reversal: lost motion (b < 0) or over-compensation (b > 0)",
                       {}},
                      {{"b", "reversal, mean(+) less mean(-)", Quantity::deviation}},
                      {},
                      applies,
                      columns});
}
