// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Stores the time constants of linear axes in each part, except ball centers.
void put_time_constants(const Campaign& campaign, const std::vector<Observations>& read,
                        std::vector<Part>& parts);

/// Returns std::nullopt if the tests determine no time constant or contradict each other, if the
/// effect has no such shape, if the readings have no times, or if the value is outside the range of
/// the search.
std::optional<Term::Stated> stated_time_constant(const Part& part, const Effect& effect,
                                                 const Axis& axis);

}  // namespace nonio::model
