// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

/// What every later stage relies on, whatever a plugin did. Called by the nightly run, `nonio
/// import`, the model and `nonio plugin check`. The error states what was found: "columns of
/// different lengths".
namespace nonio {

/// Of readings: columns of one length; deviations, positions and directions of sensing finite;
/// approaches -1, 0 or +1; uncertainties above 0; at least one line, and no reading of another;
/// doubts that are findings `plausibility.*` of attention.
Expected<void> check(const Observations& o);

/// Of results: values, uncertainties and evidence finite, coverage factors finite, columns of a
/// table or series as long as the others, a budget with one entry for each contribution. NaN stays
/// allowed in a table, where it states that there is no value.
Expected<void> check(const Evaluation& e);

/// Of what an output or controller made: predictions and evidence finite.
Expected<void> check(const OutputResult& r);

}  // namespace nonio
