// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/controllers/axis_job.h"

namespace nonio::controllers {

/// Returns jobs for the positioning from step diagonals (series EXX, EYY, EZZ; EXX_shape if the
/// scale is not known), for axes without runs of their own in that state, because those give a
/// better table. On a gantry for both sides.
std::vector<AxisJob> series_jobs(const ControllerInput&);

}  // namespace nonio::controllers
