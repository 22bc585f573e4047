// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/controllers/axis_job.h"

namespace nonio::controllers {

/// Returns jobs from step diagonals (series EXX, EYY, EZZ; EXX_shape if the scale is unknown) for
/// axes without positioning runs in the same state, which would give a better table. A gantry axis
/// gets one job per side.
std::vector<AxisJob> series_jobs(const ControllerInput&);

}  // namespace nonio::controllers
