// SPDX-License-Identifier: Apache-2.0
// A plane whose Y carries X is evaluated with exchanged axes, which is a mirror image. Conversion
// of its results:
// - EYX and EXY, with their even parts, are exchanged; q = c EXY + s EYX stays the same at each
// point.
// - C0Y and derived results keep their sign, because the right angle opens to the same side.
// - Rotations about Z change their sign.
// - The first diagonal stays the same line; the second one starts at its other end.
#include <algorithm>
#include <utility>

#include "sets.h"

namespace nonio::diagonal_straightness {

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
