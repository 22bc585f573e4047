// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"

/// Parses lengths and axes on the command line.
namespace nonio::app {

/// Converts a length from mm to m. The argument is a text, so that a decimal comma gets a better
/// error message than that of CLI11.
Expected<double> length_of(const std::string& option, const std::string& text);

/// Whether the name consists of capital letters and digits.
bool is_axis_name(const std::string& name);
/// Returns an axis that is rotary or linear by its name alone: A, B and C are rotary (ISO 841).
Axis axis_named(const std::string& name);
/// Parses the value "X=0:12000" of --axis, in mm, or in degrees for A, B and C.
Expected<Axis> axis_of(const std::string& text);

}  // namespace nonio::app
