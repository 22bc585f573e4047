// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Deviations of ball centers (one coordinate per reading) from the best-fit circle, as two lines,
/// radial and axial. Radius and height are the zeros of the lines; tangential deviations contain no
/// error of the axis. std::nullopt if no circle can be fitted, or without three coordinates of each
/// center and the axes X, Y and Z.
std::optional<Part> balls_of(const Observations& read, const Axis& axis, const std::string& id);

}  // namespace nonio::model
