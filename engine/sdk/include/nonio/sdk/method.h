// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

/// Applies a measuring method: from its readings to observations, and back.
namespace nonio {

/// Name of a column in a file, with its unit: "target_mm".
std::string name_in_file(const Method::Column& column);

/// Whether the declaration is complete and consistent: names, quantities that match the roles, and
/// without `observe` exactly one deviation, and with a position the required key `axis`.
Expected<void> check(const Method& method);

/// The observations of these readings: by the method's own function, else by the roles of its
/// columns. By roles, the position is that of `Measurement::axis`, and the deviation is sensed along
/// `Measurement::lateral`, else along the axis. A row without a deviation is a missing reading.
/// What it returns passes `check` (sdk/check.h). An error for readings that do not match the
/// declaration.
Expected<Observations> observe(const Method& method, const MethodInput& input);

/// Readings that `observe` turns into these observations: by the method's own function, else by the
/// roles of its columns. An error for a required column that the observations do not determine.
Expected<Readings> simulate(const Method& method, const SimulationInput& input);

}  // namespace nonio
