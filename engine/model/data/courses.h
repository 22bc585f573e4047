// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Appends a part for each displacement of a measurement over time that has at least 60 readings
/// with a time. Appends none if the readings are angles or the table has no times.
void append_courses(const Measurement& measurement, const Observations& read,
                    std::vector<Part>& parts);

}  // namespace nonio::model
