// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/model/measurements.h"

namespace nonio::model {

/// One part for each displacement that has at least 60 readings with a time; none for angles.
void append_courses(const Measurement& measurement, const Observations& read,
                    std::vector<Part>& parts);

}  // namespace nonio::model
