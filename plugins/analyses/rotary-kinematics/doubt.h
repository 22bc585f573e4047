// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "judge.h"
#include "nonio/math/budget.h"

namespace nonio::rotary_kinematics {

/// Derivatives of what is fitted to a circle by its coordinates: x of every centre, then y, then z.
struct Derivatives {
  using Row = std::vector<double>;
  std::array<Row, 3> centre, direction;
  Row radius;
  std::vector<Row> radial, axial;  ///< of each centre; empty above 500 of them
};
/// By central differences.
Derivatives derivatives_of(const Judged&, bool use_angles);

/// The errors of the coordinates of one circle, or of several in one frame, one behind the other:
/// the lines are x, y and z. linear_axes: bound of squareness and scale difference, if known, rad.
math::ReadingModel coordinate_model(const Campaign&, const Environment&,
                                    const std::vector<const Judged*>& circles,
                                    std::optional<double> linear_axes);

/// A derivative by the six numbers of a line (centre, direction) as one by its coordinates.
Derivatives::Row chain(const Derivatives&, const std::array<double, 6>& by_line);

}  // namespace nonio::rotary_kinematics
