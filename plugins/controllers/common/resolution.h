// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/controllers/axis_job.h"
#include "nonio/controllers/cross_job.h"
#include "nonio/math/axis_test.h"

namespace nonio::controllers {

/// The steepest step, of the mean or of one direction, that is larger than 1 um (1 arcsec) and either
/// steeper than 1000 um/m (0.36 deg per turn) though three digits of the instrument or the scatter explain
/// it, or steeper than ten times that: digits of a dial between two close targets. docs/dev/constants.md, A26.
std::optional<Unresolved> unresolved_step(const math::AxisTest& test,
                                          const math::ErrorCurve& curve);

/// The same of a curve over a linear axis that was fitted to the readings of this measurement; how they
/// scatter is not known.
std::optional<Unresolved> unresolved_step(const ControllerInput& in, const std::string& measurement,
                                          const std::vector<double>& position,
                                          const std::vector<double>& value);

/// A finding in place of a table that would be made of it.
void refuse_unresolved(const std::string& axis, const std::string& measurement, bool rotary,
                       const Unresolved& step, OutputResult& result);

/// True, with that finding, where digits of the readings would become a step of a cross table.
bool any_unresolved(const ControllerInput& in, const CrossJob& job, OutputResult& result);

}  // namespace nonio::controllers
