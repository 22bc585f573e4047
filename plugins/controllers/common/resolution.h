// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/controllers/axis_job.h"
#include "nonio/controllers/cross_job.h"
#include "nonio/math/axis_test.h"

namespace nonio::controllers {

/// Returns the steepest step of the curve that the readings do not resolve, of the mean or of one
/// direction: larger than 1 um (1 arcsec), and either steeper than 1000 um/m (0.36 deg per turn)
/// although three digits of the instrument or the scatter explain it, or steeper than ten times
/// that: digits of a dial gauge between two close targets. docs/dev/constants.md, A26.
std::optional<Unresolved> unresolved_step(const math::AxisTest& test,
                                          const math::ErrorCurve& curve);

/// Returns the steepest unresolved step of a curve over a linear axis that was fitted to the
/// readings of this measurement; their scatter is not known here.
std::optional<Unresolved> unresolved_step(const ControllerInput& in, const std::string& measurement,
                                          const std::vector<double>& position,
                                          const std::vector<double>& value);

/// Adds a finding that no table is made because of an unresolved step.
void refuse_unresolved(const std::string& axis, const std::string& measurement, bool rotary,
                       const Unresolved& step, OutputResult& result);

/// Returns true, and adds the finding of `refuse_unresolved`, if digits of the readings would cause
/// a step of a cross table.
bool any_unresolved(const ControllerInput& in, const CrossJob& job, OutputResult& result);

}  // namespace nonio::controllers
