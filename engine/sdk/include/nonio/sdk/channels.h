// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/observations.h"

namespace nonio {

/// Temperature, degC, that libraries of 1-Wire thermometers return without contact to the sensor.
inline constexpr double no_thermometer = -127.0;

/// Returns the first-order lag y of a channel x at `time` (s, in any order): dy/dt = (x - y)/tau,
/// with tau in s, exact if x is linear between its samples; tau = 0 gives the channel itself.
/// Before its first and after its last sample the channel is regarded as constant. The result is
/// relative to the channel's first value, in its unit.
std::vector<double> lagged(const Observations::Channel& channel, double tau,
                           const std::vector<double>& time);

/// Returns the first-order lag of all channels of this name at the readings, each at those of its
/// lines, minus the first value of the first one. Each starts in equilibrium with its first value. 0
/// for readings without times.
std::vector<double> lagged(const Observations& o, std::string_view name, double tau);

/// Returns the time constants, s, that readings at these times can identify, ascending: 0, and
/// values from four mean sampling intervals to 1/12 of the duration in steps of a factor sqrt(2);
/// at most 18. Empty if there are fewer than 12 different times.
std::vector<double> time_constants_for(const std::vector<double>& time);

}  // namespace nonio
