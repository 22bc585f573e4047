// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/controllers/axis_job.h"

namespace nonio::controllers {

/// Positioning as step diagonals give it (series EXX, EYY, EZZ), of axes whose own runs are not
/// among what the step diagonals were evaluated with: those make the better table.
std::vector<AxisJob> series_jobs(const ControllerInput&);

}  // namespace nonio::controllers
