// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/controllers/axis_job.h"
#include "nonio/controllers/cross_job.h"
#include "nonio/math/axis_test.h"

namespace nonio::controllers {

/// Returns the steepest step of the curve (mean or one direction) that the readings do not resolve,
/// or nullopt. It is larger than 1 um (1 arcsec), and steeper than 1000 um/m (0.36 deg per
/// revolution) although resolution or scatter explain it, or steeper than 50,000 um/m. Source:
/// docs/dev/constants.md, A26.
std::optional<Unresolved> unresolved_step(const math::AxisTest& test,
                                          const math::ErrorCurve& curve);

/// Unresolved step of a fitted curve over a linear axis, which has a resolution but no scatter.
std::optional<Unresolved> unresolved_step(const ControllerInput& in, const std::string& measurement,
                                          const std::vector<double>& position,
                                          const std::vector<double>& value);

void refuse_unresolved(const std::string& axis, const std::string& measurement, bool rotary,
                       const Unresolved& step, OutputResult& result);

/// Returns true, with a finding, if a cross table would contain an unresolved step.
bool any_unresolved(const ControllerInput& in, const CrossJob& job, OutputResult& result);

}  // namespace nonio::controllers
