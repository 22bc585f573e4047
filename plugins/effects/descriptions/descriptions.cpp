// SPDX-License-Identifier: Apache-2.0
// Effects that describe residuals without a cause. free-growth: p v_k, piecewise linear in time (p:
// position from the middle of the measured range, m or rad; v in m/m or rad/rad). free-position:
// s_k at target k; free-reversal: d r_k/2 at target k; free-time: v_k at knot k, piecewise linear
// in time. s, r, v: m or rad; d: direction of approach.
#include <algorithm>
#include <cmath>

#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::descriptions {

constexpr std::size_t fewest_targets = 5;  // minimum number of targets in ISO 230-2
constexpr std::size_t most_targets = 400;

static std::vector<double> targets(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  if (!r) return {};
  const std::vector<double> all = targets_of(*r);
  // With fewer than two readings per target, the curve would consist of the readings themselves.
  if (all.size() < fewest_targets || all.size() > most_targets || o.size() < 2 * all.size())
    return {};
  return {static_cast<double>(all.size())};
}

static std::vector<double> reversals(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  if (!r || !from_both_directions(*r) || o.size() < 4 * targets_of(*r).size()) return {};
  return targets(o, axis);
}

template <class Value>
static Expected<Effect::Columns> by_target(const Observations& o, const Axis& axis, Value of) {
  NONIO_TRY(const auto r, readings_of(o, axis));
  const std::vector<double> all = targets_of(r);
  Effect::Columns columns(all.size(), std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!r.moved[i]) continue;
    const auto after = std::upper_bound(all.begin(), all.end(), r.p[i]);
    columns[static_cast<std::size_t>(after - all.begin()) - 1][i] = of(r, i);
  }
  return columns;
}

static Expected<Effect::Columns> of_position(const Observations& o, const Axis& axis,
                                             const std::vector<double>&) {
  auto columns = by_target(o, axis, [](const AxisReadings&, std::size_t) { return 1.0; });
  if (columns && !columns->empty()) columns->erase(columns->begin());  // free zero of the line
  return columns;
}

static Expected<Effect::Columns> of_reversal(const Observations& o, const Axis& axis,
                                             const std::vector<double>&) {
  return by_target(o, axis, [](const AxisReadings& r, std::size_t i) { return r.d[i] / 2.0; });
}

/// At least six readings per knot.
static std::vector<double> knots(const Observations& o, const Axis& axis) {
  if (is_circle_without_times(o)) return {};
  const auto r = readings_of(o, axis);
  if (!r || !(r->duration > 0.0)) return {};
  std::vector<double> all;
  for (const double k : {2.0, 3.0, 4.0, 6.0, 8.0, 11.0, 16.0, 23.0, 32.0})
    if (6.0 * k <= static_cast<double>(o.size())) all.push_back(k);
  return all;
}

static Expected<Effect::Columns> of_time(const Observations& o, const Axis& axis,
                                         const std::vector<double>& shape) {
  if (shape.size() != 1 || !(shape[0] >= 2.0 && shape[0] <= 1000.0))
    return fail("free-time: expected a number of knots, 2 to 1000");
  NONIO_TRY(const auto r, readings_of(o, axis));
  const auto knots = static_cast<std::size_t>(std::lround(shape[0]));
  const double step = r.duration / static_cast<double>(knots - 1);
  Effect::Columns columns(knots - 1, std::vector<double>(o.size(), 0.0));  // 0 at the first knot
  for (std::size_t i = 0; i < o.size(); ++i)
    for (std::size_t k = 1; k < knots && r.moved[i]; ++k)
      columns[k - 1][i] = std::max(0.0, 1.0 - std::fabs(r.t[i] / step - static_cast<double>(k)));
  return columns;
}

static Expected<Effect::Columns> of_growth(const Observations& o, const Axis& axis,
                                           const std::vector<double>& shape) {
  auto columns = of_time(o, axis, shape);
  const auto r = readings_of(o, axis);
  if (!columns || !r) return columns;
  for (auto& column : *columns)
    for (std::size_t i = 0; i < o.size(); ++i) column[i] *= r->p[i];
  return columns;
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{
      .info = {"free-position", "1.0.0", "A free value for each target: a description, no cause"},
      .linear = {{"s", "value at a target", Quantity::deviation, Quantity::angular_deviation}},
      .shapes = {{{"targets", "targets", Quantity::count}, targets, false}},
      .curve = true,
      .compensable = true,
      .applies = [](const Observations& o, const Axis& axis) { return !targets(o, axis).empty(); },
      .columns = of_position,
      .description = true});
  registry.add(Effect{
      .info = {"free-reversal", "1.0.0", "A reversal for each target: a description, no cause"},
      .linear = {{"r", "reversal at a target", Quantity::deviation, Quantity::angular_deviation}},
      .shapes = {{{"targets", "targets", Quantity::count}, reversals, false}},
      .curve = true,
      .compensable = true,
      .applies = [](const Observations& o,
                    const Axis& axis) { return !reversals(o, axis).empty(); },
      .columns = of_reversal,
      .description = true});
  registry.add(Effect{
      .info = {"free-time", "1.0.0", "A free curve of time: a description, no cause"},
      .linear = {{"v", "value at a knot", Quantity::deviation, Quantity::angular_deviation}},
      .shapes = {{{"knots", "knots in time", Quantity::count}, knots, false}},
      .curve = true,
      .applies = [](const Observations& o, const Axis& axis) { return !knots(o, axis).empty(); },
      .columns = of_time,
      .description = true});
  registry.add(Effect{
      .info = {"free-growth", "1.0.0", "Thermal, position x time: a description, no cause"},
      .linear = {{"v", "growth at a knot", Quantity::deviation_per_length,
                  Quantity::deviation_per_angle}},
      .shapes = {{{"knots", "knots in time", Quantity::count}, knots, false}},
      .curve = true,
      .applies = [](const Observations& o, const Axis& axis) { return !knots(o, axis).empty(); },
      .columns = of_growth,
      .description = true});
}

}  // namespace nonio::descriptions
