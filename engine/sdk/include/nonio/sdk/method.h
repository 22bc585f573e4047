// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

namespace nonio {

/// Name of the column with the suffix of the unit: "target_mm".
std::string name_in_file(const Method::Column& column);

/// Checks that names, quantities and roles of the declaration are consistent. Without `observe`,
/// one column must be a deviation, every required column has a role, and a position column requires
/// the key `axis`.
Expected<void> check(const Method& method);

/// Converts readings to observations, by the method's own function or by the roles of its columns.
/// By roles, the position is that of `Measurement::axis`, and the deviation is sensed along
/// `Measurement::lateral` if stated, otherwise along the axis. A row without a deviation is a
/// missing reading. The result passes `check` (sdk/check.h). Error: the readings do not match the
/// declaration.
Expected<Observations> observe(const Method& method, const MethodInput& input);

/// Inverse of `observe`, by the method's own function or by the roles of its columns. Error: the
/// observations do not determine a required column.
Expected<Readings> simulate(const Method& method, const SimulationInput& input);

}  // namespace nonio
