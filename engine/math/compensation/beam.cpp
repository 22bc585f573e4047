// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/beam.h"

#include <algorithm>
#include <cmath>

namespace nonio::math {

namespace {

/// The measurement with a stated line position (`at`) for this axis of the control; nullptr: none.
const Measurement* line_on(const Campaign& campaign, const std::string& axis) {
  for (const Measurement& m : campaign.measurements)
    if (m.kind == "axis" && !m.at.empty() && control_axis(campaign.machine, m) == axis) return &m;
  return nullptr;
}

}  // namespace

std::vector<Beam> beams_of(const Campaign& campaign) {
  std::vector<Beam> beams;
  for (const Axis& a : campaign.machine.axes) {
    if (a.slave.empty()) continue;
    Beam& beam = beams.emplace_back(Beam{a.name, a.slave});
    const Measurement *one = line_on(campaign, a.name), *other = line_on(campaign, a.slave);
    if (one == nullptr || other == nullptr) continue;
    for (const auto& [axis, place] : one->at) {
      const auto there = other->at.find(axis);
      if (there == other->at.end() || there->second == place) continue;
      // sides that differ along two axes: the direction of the beam is ambiguous
      if (!beam.along.empty()) {
        beam.along.clear();
        break;
      }
      beam.along = axis, beam.at_axis = place, beam.at_slave = there->second;
    }
  }
  return beams;
}

std::optional<double> added_on_beam(
    const std::vector<Beam>& beams, const std::string& axis, Places at, MotionSigns direction,
    const std::function<double(const std::string&, const Places&, const MotionSigns&)>& side) {
  for (const Beam& b : beams) {
    if (at.contains(b.axis)) at[b.slave] = at[b.axis];
    if (direction.contains(b.axis)) direction[b.slave] = direction[b.axis];
  }
  const auto beam =
      std::find_if(beams.begin(), beams.end(), [&](const Beam& b) { return b.axis == axis; });
  const double own = side(axis, at, direction);
  if (beam == beams.end()) return own;
  constexpr double same = 1e-12;  // m
  const double other = side(beam->slave, at, direction);
  if (std::fabs(other - own) < same) return own;
  const auto y = at.find(beam->along);
  if (y == at.end()) return std::nullopt;
  return own + (other - own) * (y->second - beam->at_axis) / (beam->at_slave - beam->at_axis);
}

}  // namespace nonio::math
