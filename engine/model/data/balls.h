// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Converts centers of a ball (one coordinate per reading, as readers return them) to deviations
/// from the best-fit circle, as two lines, radial and axial. Radius and height are the zeros of the
/// lines; tangential deviations contain no error of the axis and are omitted. None if no circle can
/// be fitted, or if the table does not contain three coordinates of each center and the axes X, Y
/// and Z.
std::optional<Part> balls_of(const Observations& read, const Axis& axis, const std::string& id);

}  // namespace nonio::model
