// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/circle.h"
#include "nonio/sdk/plugin.h"

namespace nonio::circle {

struct Circle {
  std::array<std::string, 2> axis;  ///< first and second axis of the plane
  std::array<double, 2> centre{};   ///< commanded, m
  double R = 0.0;                   ///< commanded radius, m
  std::vector<math::CircleReading> readings;
  bool plus = false, minus = false;  ///< whether each direction was measured
  double step = 0.0;                 ///< typical largest angle between neighboring readings, rad

  bool both() const { return plus && minus; }
  std::vector<math::CircleReading> of(int direction, std::uint32_t run) const;
};

Expected<Circle> circle_of(const Measurement&, const Observations&);

/// Rounds x to ten digits of `size`, so that results are identical on all processors.
double steady(double x, double size);

}  // namespace nonio::circle
