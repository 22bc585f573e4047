// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "nonio/model/measurements.h"

/// What runs of an axis take from its thermal tests.
namespace nonio::model {

/// Of each part the time constants of its linear axes.
void put_time_constants(const Campaign& campaign, const std::vector<Observations>& read,
                        std::vector<Part>& parts);

/// The time constant that the thermal tests state for this effect. None if the part's readings have
/// no times, or if it is outside of the range that the effect searches.
std::optional<Term::Stated> stated_time_constant(const Part& part, const Effect& effect,
                                                 const Axis& axis);

}  // namespace nonio::model
