// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Gaps between the readings of a course, and jumps of its sensor, in the order of time.
std::vector<Restart> restarts_of(const Part& part);

/// Gives the readings from each restart on a line, and so a zero, of their own.
void put_restarts(Part& part, std::vector<Restart> restarts);

}  // namespace nonio::model
