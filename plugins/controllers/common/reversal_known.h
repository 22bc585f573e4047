// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "nonio/controllers/axis_job.h"

namespace nonio::controllers {

/// U of what the readings of this measurement have compensated, by the budget of the campaign and by
/// what drift and repetition make of them. A mean reversal that is not known well enough is taken
/// out of the curve: the table then is of the mean of both directions. docs/dev/constants.md, A28.
void take_uncertainties(const ControllerInput& input, std::size_t index, AxisJob& job);

/// The finding of a mean reversal that was taken out.
void say_held(const AxisJob& job, OutputResult& result);

}  // namespace nonio::controllers
