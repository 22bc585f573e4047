// SPDX-License-Identifier: Apache-2.0
// deviation = k p K; p: position from the middle of the measured stretch, m or rad; K: material
// temperature less its mean, K; k: 1/K.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

using namespace nonio;

static bool applies(const Observations& o, const Axis& axis) {
  constexpr double least_range = 0.05;  // K; less is the sensor's own noise
  const auto r = readings_of(o, axis);
  if (!r || !r->temperature || !(r->length > 0.0)) return false;
  const auto [low, high] = std::minmax_element(r->K.begin(), r->K.end());
  return *high - *low > least_range;
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>&) {
  return columns_of(o, axis, [](const AxisReadings& r, std::size_t i) { return r.p[i] * r.K[i]; });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"temperature", "1.0.0",
               "Expansion follows the measured temperature: wrong coefficient or no correction"},
      .linear = {{"k", "expansion left in the readings", Quantity::expansion,
                  Quantity::angular_expansion}},
      .shapes = {},
      .applies = applies,
      .columns = columns});
}
