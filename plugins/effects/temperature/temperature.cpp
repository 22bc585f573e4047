// SPDX-License-Identifier: Apache-2.0
// deviation = k (p - fixed) K; p: position from the middle of the measured range, fixed: that of
// the fixed point, m or rad; K: material temperature minus its mean, K; k: 1/K.
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::temperature {

constexpr double least_range = 0.05;  // K; a smaller range is sensor noise

static bool varies(const AxisReadings& r) {
  const auto [low, high] = std::minmax_element(r.K.begin(), r.K.end());
  return *high - *low > least_range;
}

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->temperature && r->length > 0.0 && varies(*r);
}

/// Returns the rows without a temperature if only some have none.
static WhyNot why_not(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  if (!r || !(r->length > 0.0)) return {};
  WhyNot out{"temperature-gaps"};
  for (std::uint32_t i = 0; i < o.size(); ++i)
    if (r->moved[i] && (o.material.size() != o.size() || !std::isfinite(o.material[i])))
      out.rows.push_back(i);
  const auto moved = static_cast<std::size_t>(std::count(r->moved.begin(), r->moved.end(), 1));
  if (out.rows.size() == moved) return {"no-temperature"};
  return r->temperature ? WhyNot{"temperature-constant"} : out;
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>& shape) {
  if (shape.size() != 1 || !std::isfinite(shape[0]))
    return fail("temperature: expected a fixed point");
  return columns_of(o, axis, [fixed = shape[0]](const AxisReadings& r, std::size_t i) {
    return (r.p[i] - fixed) * r.K[i];
  });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"temperature", "1.0.0",
               "Expansion follows the measured temperature: wrong coefficient or no correction"},
      .linear = {{"k", "expansion left in the readings", Quantity::expansion,
                  Quantity::angular_expansion}},
      .shapes = {fixed_point_shape()},
      .applies = applies,
      .columns = columns,
      .why_not = why_not});
}

}  // namespace nonio::temperature
