// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"

namespace nonio::app {

/// Converts a length from mm to m. An error if the text is not a number with a decimal point.
Expected<double> length_of(const std::string& option, const std::string& text);

bool is_axis_name(const std::string& name);
/// Returns an axis without travel; it is rotary if the name starts with A, B or C (ISO 841).
Axis axis_named(const std::string& name);
/// Parses an axis and its travel, such as "X=0:12000": mm, or degrees for a rotary axis, converted
/// to m or rad. An error unless the first end is below the second.
Expected<Axis> axis_of(const std::string& text);

}  // namespace nonio::app
