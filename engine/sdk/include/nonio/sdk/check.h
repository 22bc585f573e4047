// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

/// Checks of what plugins return, so that every later stage can rely on it. They are called by
/// `nonio run`, `nonio import`, the model and `nonio plugin check`. The error states what was
/// found, such as "columns of different lengths".
namespace nonio {

/// Checks readings: columns have one length or are empty; deviations, positions and directions of
/// sensing are finite; approaches are -1, 0 or +1; uncertainties are above 0; each channel has
/// finite values at ascending times; each reading belongs to an existing line; `doubts` are
/// findings `plausibility.*` with attention set.
Expected<void> check(const Observations& o);

/// Checks results: values, uncertainties, coverage factors and evidence are finite, the columns of
/// a table or series have one length, and a budget has one entry for each contribution. NaN is
/// allowed in a table, where it means that there is no value.
Expected<void> check(const Evaluation& e);

/// Checks the result of an output or controller: predictions and evidence are finite.
Expected<void> check(const OutputResult& r);

}  // namespace nonio
