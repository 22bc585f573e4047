// SPDX-License-Identifier: Apache-2.0
// Run-out of a rotary axis from ball centers. Radial readings (first line) or axial readings
// (second line): sum over k = 2 .. m + 1 of a_k cos(k theta) + b_k sin(k theta). theta: angle of
// the axis, rad; a, b: m. k = 1 would be the center or the direction of the axis.
#include <set>

#include "nonio/sdk/space_readings.h"

namespace nonio::run_out {

namespace {

/// m = 1 to 3. The circle leaves n - 3 values of n angles, of which at most half are used.
std::vector<double> grid(const Observations& o, const Axis&) {
  if (!of_ball_centres(o)) return {};
  const std::set<double> angles(o.axes.front().position.begin(), o.axes.front().position.end());
  std::vector<double> waves;
  for (std::size_t m = 1;
       m <= 3 && 4 * m <= angles.size() - std::min<std::size_t>(angles.size(), 3); ++m)
    waves.push_back(static_cast<double>(m));
  return waves;
}

Expected<Effect::Columns> columns(const Observations& o, const std::vector<double>& shape,
                                  std::uint32_t line) {
  if (shape.size() != 1 || !(shape[0] >= 1.0 && shape[0] <= 100.0))
    return fail("run-out: expected a number of waves, 1 to 100");
  if (!of_ball_centres(o)) return fail("run-out: expected centres of a ball");
  const auto waves = static_cast<std::size_t>(std::lround(shape[0]));
  Effect::Columns out(2 * waves, std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < o.line.size(); ++i) {
    if (o.line_of(i) != line) continue;
    for (std::size_t w = 0; w < waves; ++w) {
      const double angle = static_cast<double>(w + 2) * o.axes.front().position[i];
      out[2 * w][i] = std::cos(angle);
      out[2 * w + 1][i] = std::sin(angle);
    }
  }
  return out;
}

Effect effect_of(const char* kind, const char* summary, std::uint32_t line) {
  Effect e;
  e.info = {kind, "1.0.0", summary};
  e.linear = {{"a", "cosine and sine of each wave, from two a turn on", Quantity::deviation}};
  e.shapes = {{{"waves", "how many waves, from two a turn on", Quantity::count}, grid, false}};
  e.curve = true;
  e.applies = [](const Observations& o, const Axis& a) { return !grid(o, a).empty(); };
  e.columns = [line](const Observations& o, const Axis&, const std::vector<double>& shape) {
    return columns(o, shape, line);
  };
  e.instances = [](const Observations& o) {
    return of_ball_centres(o) ? std::vector<std::string>{o.axes.front().axis}
                              : std::vector<std::string>{};
  };
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(effect_of("radial-run-out", "The rotary axis wanders across itself as it turns", 0));
  registry.add(effect_of("axial-run-out", "The rotary axis rises and falls as it turns", 1));
}

}  // namespace nonio::run_out
