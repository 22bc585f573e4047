// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/controllers/axis_job.h"

namespace nonio::controllers {

/// Positioning as step diagonals give it (series EXX, EYY, EZZ; EXX_shape where the scale is not known), of axes
/// without runs of their own of that state: those make the better table. On a gantry of both sides.
std::vector<AxisJob> series_jobs(const ControllerInput&);

}  // namespace nonio::controllers
