// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "nonio/controllers/axis_job.h"

namespace nonio::controllers {

/// Sets job.U from the budget of the campaign, drift and repetition. If U of the mean reversal is
/// at least half of it, the reversal is removed from the curve, so that the table compensates the
/// mean of both directions. Source: docs/dev/constants.md, A28.
void take_uncertainties(const ControllerInput& input, std::size_t index, AxisJob& job);

/// Adds the finding about a mean reversal that was removed.
void say_held(const AxisJob& job, OutputResult& result);

}  // namespace nonio::controllers
