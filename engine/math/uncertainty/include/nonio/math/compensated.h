// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/axis_test.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"

namespace nonio::math {

/// U (k = 2) of what a table compensates, m or rad; 0: not known.
struct CompensatedUncertainty {
  double B_mean = 0.0, E = 0.0, M = 0.0;
};

/// By the budget of the campaign and, if `has_drift`, what drift and repetition make of the readings
/// (false where a model has taken the drift out of them). docs/dev/constants.md, A28.
CompensatedUncertainty compensated_uncertainty(const Campaign&, const Measurement&,
                                               const Observations&, const AxisTest&,
                                               bool has_drift);

/// A deviation after compensation as it is stated: what is not known is not compensated, so it is not
/// smaller than U, nor than `before`.
double predicted_after(double before, double after, double U);

}  // namespace nonio::math
