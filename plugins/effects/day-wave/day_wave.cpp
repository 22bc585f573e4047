// SPDX-License-Identifier: Apache-2.0
// day-wave: deviation = (p - fixed) (a sin(w t) + b (1 - cos(w t))); zero-wave: the same without (p
// - fixed). p: position from the middle of the measured range, fixed: that of the fixed point, m or
// rad; t: time since the first reading of its line, s; w = 2 pi/86400 s. a, b: m/m or rad/rad; of
// zero-wave m or rad.
#include <cmath>
#include <numbers>

#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::day_wave {

constexpr double day = 86400.0;         // s
constexpr double shortest = day / 6.0;  // s, minimum duration for a wave
constexpr double of_time = 2.0 * std::numbers::pi / day;

static bool long_enough(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->timed && r->length > 0.0 && r->duration >= shortest;
}

static WhyNot why_not(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  if (!r || !(r->length > 0.0)) return {};
  return {r->timed ? "short-test" : "no-times"};
}

static Expected<Effect::Columns> growth(const Observations& o, const Axis& axis,
                                        const std::vector<double>& shape) {
  if (shape.size() != 1 || !std::isfinite(shape[0]))
    return fail("day-wave: expected a fixed point");
  const double fixed = shape[0];
  return columns_of(
      o, axis,
      [fixed](const AxisReadings& r, std::size_t i) {
        return (r.p[i] - fixed) * std::sin(of_time * r.t[i]);
      },
      [fixed](const AxisReadings& r, std::size_t i) {
        return (r.p[i] - fixed) * (1.0 - std::cos(of_time * r.t[i]));
      });
}

static Expected<Effect::Columns> zero(const Observations& o, const Axis& axis,
                                      const std::vector<double>&) {
  return columns_of(
      o, axis, [](const AxisReadings& r, std::size_t i) { return std::sin(of_time * r.t[i]); },
      [](const AxisReadings& r, std::size_t i) { return 1.0 - std::cos(of_time * r.t[i]); });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"day-wave", "1.0.0", "Screw or scale grows and shrinks with day and night: 24 h"},
      .linear = {{"a", "growth with the sine of the day", Quantity::deviation_per_length,
                  Quantity::deviation_per_angle},
                 {"b", "growth with one less its cosine", Quantity::deviation_per_length,
                  Quantity::deviation_per_angle}},
      .shapes = {fixed_point_shape()},
      .applies = long_enough,
      .columns = growth,
      .why_not = why_not});
  registry.add(
      Effect{.info = {"zero-wave", "1.0.0", "All readings move together with day and night: 24 h"},
             .linear = {{"a", "zero with the sine of the day", Quantity::deviation,
                         Quantity::angular_deviation},
                        {"b", "zero with one less its cosine", Quantity::deviation,
                         Quantity::angular_deviation}},
             .shapes = {},
             .applies = long_enough,
             .columns = zero,
             .why_not = why_not});
}

}  // namespace nonio::day_wave
