// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"

/// Lengths and axes on the command line.
namespace nonio::app {

/// A length in mm as SI. Taken as a text: a decimal comma deserves a better word than "could not
/// convert".
Expected<double> length_of(const std::string& option, const std::string& text);

/// Capital letters and digits.
bool is_axis_name(const std::string& name);
/// By its name alone: A, B and C turn (ISO 841).
Axis axis_named(const std::string& name);
/// "X=0:12000" of --axis; of A, B and C in degrees.
Expected<Axis> axis_of(const std::string& text);

}  // namespace nonio::app
