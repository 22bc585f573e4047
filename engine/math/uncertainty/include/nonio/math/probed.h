// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "nonio/math/budget.h"

/// Positions in space that the linear axes of a machine measure: centers of a ball under a probe.
namespace nonio::math {

struct ProbedPlaces {
  std::vector<std::array<double, 3>> at;  ///< positions, m, in the order in which they were read
  std::array<double, 3> middle{};         ///< point from which squareness and scale errors grow
  double radius = 0.0;                    ///< largest distance of a place from `middle`, m
  /// Bound of the squareness and scale differences of the linear axes, rad, and its manifest key.
  std::optional<double> linear_axes{};
  std::string linear_axes_key{};
};

/// The model has three lines: x, y and z of all places.
ReadingModel probed_model(const Campaign&, const Environment&, const ProbedPlaces&);

}  // namespace nonio::math
