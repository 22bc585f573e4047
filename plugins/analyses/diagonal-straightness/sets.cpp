// SPDX-License-Identifier: Apache-2.0
#include "sets.h"

#include <algorithm>
#include <utility>

namespace nonio::diagonal_straightness {

std::vector<Set> sets_of(const Campaign& campaign) {
  std::vector<Set> sets;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.kind != "diagonal") continue;
    const std::string name = state_of(m);
    auto at = std::find_if(sets.begin(), sets.end(), [&](const Set& s) { return s.name == name; });
    if (at == sets.end()) at = sets.insert(sets.end(), Set{name, {}});
    at->lines.push_back(i);
  }
  // The first set is the one before the adjustment; unless stated, the first of the manifest.
  const auto rank = [&](const Set& set) {
    for (const std::size_t i : set.lines)
      if (const std::string& stated = campaign.measurements[i].adjustment; !stated.empty())
        return stated == "before" ? 0 : 2;
    return 1;
  };
  std::stable_sort(sets.begin(), sets.end(),
                   [&](const Set& a, const Set& b) { return rank(a) < rank(b); });
  return sets;
}

const Set* set_led_by(const std::vector<Set>& sets, const Campaign& campaign,
                      const Measurement& m) {
  for (const Set& set : sets)
    if (campaign.measurements[set.lines.front()].id == m.id) return &set;
  return nullptr;
}

// A plane whose Y carries X is evaluated with exchanged axes, which is a mirror image. Conversion
// of its results:
// - EYX and EXY, with their even parts, are exchanged; q = c EXY + s EYX stays the same at each
// point.
// - C0Y and derived results keep their sign, because the right angle opens to the same side.
// - Rotations about Z change their sign.
// - The first diagonal stays the same line; the second one starts at its other end.
namespace {

void negate(std::vector<double>& values) {
  for (double& v : values) v = -v;
}

void turn_line(std::vector<double>& values) {
  std::reverse(values.begin(), values.end());
  negate(values);
}

}  // namespace

void turn_back(Collected& c, math::DiagonalResult& r) {
  std::swap(c.x_axis, c.y_axis);
  std::swap(c.x0, c.y0);
  std::swap(c.readings.Lx, c.readings.Ly);
  turn_line(c.readings.D2.mean);
  turn_line(r.d2);
  const double first = r.d2.empty() ? 0.0 : r.d2.front();
  for (double& v : r.d2) v -= first;
  std::swap(r.EYX, r.EXY);
  std::swap(r.EYX_even, r.EXY_even);
  std::swap(r.lsq.EYX, r.lsq.EXY);
  std::swap(r.EYX_agrees, r.EXY_agrees);
  negate(r.ECX.value);
}

}  // namespace nonio::diagonal_straightness
