// SPDX-License-Identifier: Apache-2.0
// Effects that break one law each, which their name says.
#include <cmath>
#include <numbers>

#include "nonio/sdk/axis_readings.h"

using namespace nonio;

namespace {

using Column = double (*)(const AxisReadings&, std::size_t);

bool moves(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->length > 0.0;
}

Expected<Effect::Columns> dependent(const Observations& o, const Axis& axis,
                                    const std::vector<double>&) {
  const Column p = [](const AxisReadings& r, std::size_t i) { return r.p[i]; };
  const Column twice = [](const AxisReadings& r, std::size_t i) { return 2.0 * r.p[i]; };
  return columns_of(o, axis, p, twice);
}

Expected<Effect::Columns> constant(const Observations& o, const Axis& axis,
                                   const std::vector<double>&) {
  return columns_of(o, axis, [](const AxisReadings&, std::size_t) { return 1.0; });
}

Expected<Effect::Columns> moving(const Observations& o, const Axis& axis,
                                 const std::vector<double>&) {
  const auto r = readings_of(o, axis);
  if (!r) return fail(r.error());
  auto column = o.axis(axis.name)->position;
  for (double& x : column)
    if (!std::isfinite(x)) x = 0.0;
  return Effect::Columns{column};
}

Expected<Effect::Columns> in_order(const Observations& o, const Axis& axis,
                                   const std::vector<double>&) {
  return columns_of(o, axis, [&](const AxisReadings&, std::size_t i) {
    return static_cast<double>(i) / static_cast<double>(o.size());
  });
}

Expected<Effect::Columns> crashing(const Observations& o, const Axis& axis,
                                   const std::vector<double>&) {
  volatile int* nowhere = nullptr;
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): the fault is the test
  if (o.size() == 0) *nowhere = 1;
  return columns_of(o, axis, [](const AxisReadings& r, std::size_t i) { return r.p[i]; });
}

Expected<Effect::Columns> waves(const Observations& o, const Axis& axis,
                                const std::vector<double>& shape) {
  if (shape.size() != 1 || !(shape[0] > 0.0)) return fail("expected a period");
  const double w = 2.0 * std::numbers::pi / shape[0];
  return columns_of(
      o, axis, [w](const AxisReadings& r, std::size_t i) { return std::sin(w * r.p[i]); },
      [w](const AxisReadings& r, std::size_t i) { return std::cos(w * r.p[i]); });
}

Effect made(const char* name, std::size_t parameters,
            Expected<Effect::Columns> (*columns)(const Observations&, const Axis&,
                                                 const std::vector<double>&)) {
  Effect e;
  e.info = {name, "1", "Wrong on purpose"};
  for (std::size_t k = 0; k < parameters; ++k)
    e.linear.push_back({std::string(1, static_cast<char>('a' + k)), "", Quantity::deviation});
  e.applies = moves;
  e.columns = columns;
  return e;
}

Effect with_grid(const char* name, std::vector<double> grid) {
  Effect e = made(name, 2, waves);
  e.shapes = {{{"P", "period", Quantity::length},
               [grid](const Observations&, const Axis&) { return grid; }}};
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(made("dependent-columns", 2, dependent));
  registry.add(made("constant-column", 1, constant));
  registry.add(made("moving-while-still", 1, moving));
  registry.add(made("order-of-rows", 1, in_order));
  registry.add(made("crash-on-empty", 1, crashing));
  registry.add(with_grid("coarse-grid", {0.1, 0.17, 0.3}));
  registry.add(with_grid("double-grid", {0.2, 0.2, 0.2002}));
}
