// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/observations.h"

/// First-order lags of recorded channels, from which effects of channels compute their columns.
namespace nonio {

/// Returns the first-order lag y of a channel x at the times of the readings: dy/dt = (x - y)/tau,
/// exact if x is linear between its samples; tau 0 gives the channel itself. The channel is taken
/// as constant before its first and after its last sample. The result is in the unit of the
/// channel, minus the channel's first value. `time`: time of each reading, s, in any order; `tau`
/// in s.
std::vector<double> lagged(const Observations::Channel& channel, double tau,
                           const std::vector<double>& time);

/// Returns the first-order lag of all channels of this name at the readings, each at those of its
/// lines, minus the first value of the first one. Each starts in equilibrium with its first value. 0
/// for readings without times.
std::vector<double> lagged(const Observations& o, std::string_view name, double tau);

/// Returns the time constants, s, that readings at these times can identify, ascending: 0, and
/// values up to 1/12 of the duration in steps of a factor sqrt(2), none below four mean sampling
/// intervals; at most 18. Empty if there are fewer than 12 different times.
std::vector<double> time_constants_for(const std::vector<double>& time);

}  // namespace nonio
