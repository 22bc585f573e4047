// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "nonio/math/budget.h"

/// Places in space that the linear axes of a machine read: centres of a ball under a probe.
namespace nonio::math {

struct ProbedPlaces {
  std::vector<std::array<double, 3>> at;  ///< m, in the order in which they were read
  std::array<double, 3> middle{};         ///< from which squareness and scale count
  double radius = 0.0;                    ///< how far they lie from it at most
  /// Bound of squareness and scale difference of the linear axes, rad, if it is known; its key.
  std::optional<double> linear_axes{};
  std::string linear_axes_key{};
};

/// The errors of the coordinates: the lines are x, y and z of all places.
ReadingModel probed_model(const Campaign&, const Environment&, const ProbedPlaces&);

}  // namespace nonio::math
