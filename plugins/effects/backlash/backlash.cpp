// SPDX-License-Identifier: Apache-2.0
// deviation = b d/2; d: direction of approach, +1 or -1; b: m or rad, negative for lost motion.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

using namespace nonio;

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && std::any_of(r->d.begin(), r->d.end(), [](double d) { return d > 0.0; }) &&
         std::any_of(r->d.begin(), r->d.end(), [](double d) { return d < 0.0; });
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  auto r = readings_of(o, axis);
  if (!r) return fail(r.error());
  for (double& d : r->d) d *= 0.5;
  return Effect::Columns{std::move(r->d)};
}

NONIO_PLUGIN(registry) {
  registry.add(
      Effect{.info = {"backlash", "1.0.0",
                      "Constant reversal: lost motion (b < 0) or over-compensation (b > 0)"},
             .linear = {{"b", "reversal, mean(+) less mean(-)", Quantity::deviation,
                         Quantity::angular_deviation}},
             .shapes = {},
             .compensable = true,
             .applies = applies,
             .columns = columns});
}
