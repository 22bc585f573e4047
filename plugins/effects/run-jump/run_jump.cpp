// SPDX-License-Identifier: Apache-2.0
// deviation = j for t > instant, otherwise 0; t: time since the first reading of its line, s; j: m
// or rad.
#include <utility>

#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"
#include "nonio/sdk/space_readings.h"

namespace nonio::run_jump {

static std::vector<double> thinned(std::vector<double> instants, std::size_t most) {
  std::sort(instants.begin(), instants.end());
  instants.erase(std::unique(instants.begin(), instants.end()), instants.end());
  if (instants.size() <= most) return instants;
  std::vector<double> kept;
  for (std::size_t k = 0; k < most; ++k)
    kept.push_back(instants[k * (instants.size() - 1) / (most - 1)]);
  return kept;
}

/// Lines that are not straight: there, lateral play and spikes at reversals look like jumps within a
/// run.
static std::vector<bool> curved_lines(const Observations& o) {
  std::vector<bool> out(std::max<std::size_t>(o.lines.size(), 1), false);
  if (o.axes.size() < 2) return out;
  const SpaceReadings s = space_of(o);
  for (std::size_t line = 0; line < o.lines.size(); ++line)
    out[line] = !space_line(o, s, line).straight;
  return out;
}

/// Instants to be tested, s, between consecutive readings of a line: more at ends of passes (change
/// of run or direction) than within passes; on a circle only between runs. A single reading on one
/// side is a misreading.
static std::vector<double> grid(const Observations& o, const Axis& axis) {
  constexpr std::size_t most_ends = 300, most_others = 100, fewest = 2;
  const auto r = readings_of(o, axis);
  if (!r) return {};
  const auto line = [&](std::size_t i) { return o.line.empty() ? 0 : o.line[i]; };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (r->moved[i]) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(line(a), r->t[a]) < std::pair(line(b), r->t[b]);
  });
  const std::vector<bool> curved = curved_lines(o);
  std::vector<double> ends, others;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const std::size_t a = order[k - 1], b = order[k];
    const bool few = k < fewest || k + fewest > order.size() ||
                     line(order[k - fewest]) != line(b) || line(order[k + fewest - 1]) != line(b);
    if (few || !(r->t[b] > r->t[a])) continue;
    const bool other_run = !o.run.empty() && o.run[a] != o.run[b];
    if (curved[line(a)] && !other_run) continue;
    const bool end = other_run || r->d[a] != r->d[b];
    (end ? ends : others).push_back(r->t[a] + (r->t[b] - r->t[a]) / 2.0);
  }
  std::vector<double> instants = thinned(std::move(ends), most_ends);
  const std::vector<double> more = thinned(std::move(others), most_others);
  instants.insert(instants.end(), more.begin(), more.end());
  return thinned(std::move(instants), most_ends + most_others);
}

static bool applies(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && r->duration > 0.0 && !grid(o, axis).empty();
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>& shape) {
  if (shape.size() != 1) return fail("run-jump: expected an instant");
  return columns_of(o, axis, [instant = shape[0]](const AxisReadings& r, std::size_t i) {
    return r.t[i] > instant ? 1.0 : 0.0;
  });
}

NONIO_PLUGIN(registry) {
  registry.add(
      Effect{.info = {"run-jump", "1.0.0",
                      "All readings after one instant are shifted: a slip of optics or datum"},
             .linear = {{"j", "shift after the instant", Quantity::deviation,
                         Quantity::angular_deviation}},
             .shapes = {{{"instant", "when it happened, from the first reading", Quantity::time},
                         grid,
                         false}},
             .applies = applies,
             .columns = columns,
             .why_not = no_order});
}

}  // namespace nonio::run_jump
