// SPDX-License-Identifier: Apache-2.0
#include "readings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nonio::circle {

std::vector<math::CircleReading> Circle::of(int direction, std::uint32_t run) const {
  std::vector<math::CircleReading> out;
  for (const math::CircleReading& r : readings)
    if (r.run == run && (direction == 0 || r.direction == direction)) out.push_back(r);
  return out;
}

Expected<Circle> circle_of(const Measurement& m, const Observations& o) {
  Circle out;
  for (const auto& [axis, from] : m.from) {
    const auto to = m.to.find(axis);
    const bool first = to != m.to.end() && to->second != from;
    out.axis[first ? 0 : 1] = axis;
    out.centre[first ? 0 : 1] = from;
    if (first) out.R = to->second - from;
  }
  const std::size_t u = coordinate_of(out.axis[0]), v = coordinate_of(out.axis[1]);
  const auto *first = o.axis(out.axis[0]), *second = o.axis(out.axis[1]);
  if (u > 2 || v > 2 || !(out.R > 0.0) || first == nullptr || second == nullptr ||
      first->approach.size() != o.size() || second->approach.size() != o.size())
    return fail("expected readings of a circle, with its plane, radius and centre");
  for (std::size_t i = 0; i < o.size(); ++i) {
    const auto& n = o.sense_of(i);
    // The sign of n x (direction of travel) is the direction of rotation about the center.
    const double turn = n[u] * second->approach[i] - n[v] * first->approach[i];
    const int d = turn > 0.0 ? 1 : -1;
    double angle = std::atan2(n[v], n[u]);
    if (angle < 0.0) angle += 2.0 * std::numbers::pi;
    out.readings.push_back({angle, o.deviation[i], d, o.run_of(i)});
    (d > 0 ? out.plus : out.minus) = true;
  }
  std::vector<double> angles;
  for (const auto& r : out.readings)
    if (r.direction == out.readings.front().direction && r.run == out.readings.front().run)
      angles.push_back(r.angle);
  std::sort(angles.begin(), angles.end());
  std::vector<double> steps;
  for (std::size_t i = 1; i < angles.size(); ++i) steps.push_back(angles[i] - angles[i - 1]);
  if (!steps.empty()) {
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    out.step = 3.0 * steps[steps.size() / 2] + 1e-9;
  }
  return out;
}

double steady(double x, double size) {
  if (!(size > 0.0) || !std::isfinite(x)) return x;
  const double step = std::pow(10.0, std::floor(std::log10(size)) - 9.0);
  return std::round(x / step) * step;
}

}  // namespace nonio::circle
