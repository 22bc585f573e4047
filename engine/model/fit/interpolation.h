// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"

namespace nonio::model {

/// Returns the possible error of the terms' predictions caused by interpolated temperatures: n x k,
/// m or rad, one column per independent error of one standard uncertainty; with more than 50 gaps
/// on an axis, several share a column. The error of linear interpolation is estimated where
/// temperatures are known, over stretches as long as the gap. `linear`: linear parameters of each
/// term. Returns no columns if no temperature is interpolated or no term depends on temperature; an
/// error if too few temperatures are known.
Expected<MatrixXd> wrong_by_interpolation(const Observations& o, const std::vector<Term>& terms,
                                          const std::vector<VectorXd>& linear);

}  // namespace nonio::model
