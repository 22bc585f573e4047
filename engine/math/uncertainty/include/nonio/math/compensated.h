// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/axis_test.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"

namespace nonio::math {

/// Expanded uncertainties (k = 2) of the errors that a table compensates, m or rad; 0: not known.
struct CompensatedUncertainty {
  /// B: of the largest reversal of a target. B and B_mean contain drift and repetition.
  double B_mean = 0.0, B = 0.0, E = 0.0, M = 0.0;
};

/// `has_drift`: whether drift and repetition of the readings contribute; false if a model has
/// removed the drift. docs/dev/constants.md, A28.
CompensatedUncertainty compensated_uncertainty(const Campaign&, const Measurement&,
                                               const Observations&, const AxisTest&,
                                               bool has_drift);

/// Expanded uncertainty (k = 2) of the range of mean deviations along a diagonal, m; NaN: not known.
double compensated_uncertainty_along(const Campaign&, const Measurement&, const Observations&);

/// Returns the deviation to be stated after compensation: `after`, but at least min(U, before),
/// because errors below U are not known and therefore not compensated. If U is NaN, more than the
/// returned value may remain.
double predicted_after(double before, double after, double U);
/// The same of E, whose U may be unknown while that of B is known: E is never below B. `B_after` is
/// NaN or 0 without one.
double predicted_E_after(double before, double after, double U, double U_B, double B_after);

}  // namespace nonio::math
