// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "nonio/controllers/axis_job.h"

namespace nonio::controllers {

/// Sets U of the errors that a table of this measurement compensates, from the budget of the
/// campaign and from drift and repetition. If the mean reversal is not known well enough, it is
/// removed from the curve: the table is then that of the mean of both directions.
/// docs/dev/constants.md, A28.
void take_uncertainties(const ControllerInput& input, std::size_t index, AxisJob& job);

/// Adds the finding about a mean reversal that was removed.
void say_held(const AxisJob& job, OutputResult& result);

}  // namespace nonio::controllers
