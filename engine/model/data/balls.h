// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Centres of a ball (a coordinate a reading, as readers give them) as what is left of the nearest
/// circle: two lines, radial and axial. Radius and height are the zeros of the lines; tangential
/// deviations show nothing of the axis and are left out. None if there is no circle to be found.
std::optional<Part> balls_of(const Observations& read, const Axis& axis, const std::string& id);

}  // namespace nonio::model
