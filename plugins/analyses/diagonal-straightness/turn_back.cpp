// SPDX-License-Identifier: Apache-2.0
//
// A plane whose Y carries X was evaluated with both axes exchanged, which is a mirror image. In it
//   EYX and EXY, even parts too, have each other's name; q = c EXY + s EYX is the same at each point
//   the right angle opens to the same side: C0Y and what follows from it keep their sign
//   a turn about Z has the other sign
//   the first diagonal is the same line; the second one begins at its other end
#include <algorithm>
#include <utility>

#include "sets.h"

namespace nonio::diagonal_straightness {

namespace {

void negate(std::vector<double>& values) {
  for (double& v : values) v = -v;
}

/// Deviations along a line that is named from its other end.
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
