// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

/// Checks of the results of plugins, on which all later stages rely. The error describes the
/// defect, such as "columns of different lengths".
namespace nonio {

/// Requires columns of one length or empty; finite deviations, positions and directions of sensing;
/// approaches -1, 0 or +1; uncertainties above 0; channels with finite values at ascending times;
/// lines that exist; and `doubts` that are findings `plausibility.*` with attention set.
Expected<void> check(const Observations& o);

/// Requires distinct names of values, series and columns; finite values, uncertainties, coverage factors and evidence; columns of equal length in
/// a table or series; and one budget entry for each contribution. NaN in a table means that there
/// is no value.
Expected<void> check(const Evaluation& e);

/// Requires finite predictions and evidence.
Expected<void> check(const OutputResult& r);

}  // namespace nonio
