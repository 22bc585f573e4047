// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/controllers/axis_job.h"
#include "nonio/controllers/cross_job.h"
#include "nonio/math/axis_test.h"

namespace nonio::controllers {

/// Returns the steepest step of the curve (mean or one direction) that the readings do not resolve;
/// nullopt: none. It is larger than 1 um (1 arcsec), and steeper than 1000 um/m (0.36 deg per turn)
/// although resolution or scatter explain it, or steeper than 50,000 um/m. Source:
/// docs/dev/constants.md, A26.
std::optional<Unresolved> unresolved_step(const math::AxisTest& test,
                                          const math::ErrorCurve& curve);

/// Returns the steepest unresolved step of a fitted curve over a linear axis. The resolution of the
/// measurement is used, but not its scatter.
std::optional<Unresolved> unresolved_step(const ControllerInput& in, const std::string& measurement,
                                          const std::vector<double>& position,
                                          const std::vector<double>& value);

/// Adds a finding that no table is written because of an unresolved step.
void refuse_unresolved(const std::string& axis, const std::string& measurement, bool rotary,
                       const Unresolved& step, OutputResult& result);

/// Returns true, and adds a finding, if a cross table would contain an unresolved step.
bool any_unresolved(const ControllerInput& in, const CrossJob& job, OutputResult& result);

}  // namespace nonio::controllers
