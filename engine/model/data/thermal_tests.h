// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "nonio/model/measurements.h"

/// Use of thermal tests of an axis in the model of its axis tests.
namespace nonio::model {

/// Stores in each part, except ball centers, the time constants that thermal tests determine for
/// its linear axes.
void put_time_constants(const Campaign& campaign, const std::vector<Observations>& read,
                        std::vector<Part>& parts);

/// Returns the time constant from thermal tests for this effect of an axis. None if the tests
/// determine none or contradict each other, if the effect has no such shape, if the part's readings
/// have no times, or if the value is outside the range that the effect searches.
std::optional<Term::Stated> stated_time_constant(const Part& part, const Effect& effect,
                                                 const Axis& axis);

}  // namespace nonio::model
