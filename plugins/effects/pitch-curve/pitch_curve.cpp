// SPDX-License-Identifier: Apache-2.0
// deviation = sum c_k s_k(p); s_k: smooth basis of cubic splines without constant and slope
// (nonio/math/spline.h), dimensionless, rms 1 over the targets; p: position from the center of the
// measured range, m or rad; c_k: m or rad.
// part-pitch-curve: the same in the frame of a part, if parts were turned by different angles.
#include "nonio/math/spline.h"
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"
#include "nonio/sdk/space_readings.h"

namespace nonio::pitch_curve {

/// Numbers of knots: at most 10, with at least three targets per two free values, so that the curve
/// cannot follow single targets; of features of a part, which repeat each position of an axis, also
/// two for 4 or 5 positions. `explain` omits curves that need more than half of the targets.
static std::vector<double> grid(const Observations& o, const Axis& axis) {
  constexpr int fewest = 3, most = 10;
  constexpr std::size_t fewest_targets = 6;
  const auto r = readings_of(o, axis);
  if (!r) return {};
  const std::vector<double> targets = targets_of(*r);
  if (of_parts(o) && targets.size() < fewest_targets) return knots_over(targets);
  if (targets.size() < fewest_targets) return {};
  const int last = static_cast<int>(std::min<std::size_t>(targets.size() * 2 / 3, most + 1)) - 1;
  std::vector<double> knots;
  for (int k = fewest; k <= last && math::smooth_basis({}, targets, k); ++k) knots.push_back(k);
  return knots;
}

static bool applies(const Observations& o, const Axis& axis) { return !grid(o, axis).empty(); }

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>& shape) {
  if (shape.size() != 1 || !(shape[0] >= 2.0 && shape[0] <= 1000.0))
    return fail("pitch-curve: expected a number of knots, 2 to 1000");
  NONIO_TRY(const auto r, readings_of(o, axis));
  auto columns = math::smooth_basis(r.p, targets_of(r), static_cast<int>(std::lround(shape[0])));
  if (!columns) return fail("pitch-curve: " + columns.error().message);
  for (auto& column : *columns)
    for (std::size_t i = 0; i < column.size(); ++i)
      if (!r.moved[i]) column[i] = 0.0;
  return columns;
}

NONIO_PLUGIN(registry) {
  const Effect curve{.info = {"pitch-curve", "1.0.0",
                              "Smooth pitch error of screw or scale, without constant and slope"},
                     .linear = {{"s", "rms of the curve over the targets", Quantity::deviation,
                                 Quantity::angular_deviation}},
                     .shapes = {{{"knots", "knots of the spline", Quantity::count}, grid, false}},
                     .curve = true,
                     .compensable = true,
                     .of_part = "part-pitch-curve",
                     .applies = applies,
                     .columns = columns,
                     .why_not = [](const Observations& o, const Axis& axis) {
                       return WhyNot{readings_of(o, axis) ? "few-targets" : ""};
                     }};
  registry.add(curve);
  registry.add(in_frame_of_parts(
      curve, {"part-pitch-curve", "1.0.0",
              "A position error that turns with the part: of fixture or measuring machine"}));
}

}  // namespace nonio::pitch_curve
