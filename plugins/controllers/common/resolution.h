// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "nonio/controllers/axis_job.h"
#include "nonio/math/axis_test.h"

namespace nonio::controllers {

/// The steepest step that is larger than 1 um (1 arcsec) and either steeper than 1000 um/m (0.36 deg
/// per turn) though the resolution of the instrument and the scatter explain it, or steeper than ten
/// times that: digits of a dial between two close targets. docs/constants.md, A26.
std::optional<Unresolved> unresolved_step(const math::AxisTest& test,
                                          const math::ErrorCurve& curve);

/// A finding in place of a table that would be made of it.
void refuse_unresolved(const AxisJob& job, const Unresolved& step, OutputResult& result);

}  // namespace nonio::controllers
