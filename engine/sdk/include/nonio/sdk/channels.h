// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/observations.h"

/// What effects of recorded channels are made of.
namespace nonio {

/// First-order lag of a channel, at the times of the readings: dy/dt = (x - y)/tau, exact for an x
/// that is linear between its samples; tau 0: the channel itself. Before its first sample the channel
/// is taken as constant, after its last one too. In the unit of the channel, less its first value.
/// time: of each reading, s, in any order; tau in s.
std::vector<double> lagged(const Observations::Channel& channel, double tau,
                           const std::vector<double>& time);

/// Time constants that readings at these times can show: 0, then by factors of the root of 2 to a twelfth
/// of the duration, not below four sampling intervals, s; at most 18. Empty for fewer than 12 different times.
std::vector<double> time_constants_for(const std::vector<double>& time);

}  // namespace nonio
