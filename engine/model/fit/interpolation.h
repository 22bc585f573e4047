// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"

namespace nonio::model {

/// Possible errors of the predictions by interpolated temperatures: n x k, m or rad, one column per
/// independent error of one standard uncertainty (at most 50 on an axis). The error is estimated
/// where temperatures are known, over stretches as long as the gap. `linear`: linear parameters of
/// each term. No columns without interpolated temperatures or terms that depend on temperature.
/// Error: too few known temperatures.
Expected<MatrixXd> wrong_by_interpolation(const Observations& o, const std::vector<Term>& terms,
                                          const std::vector<VectorXd>& linear);

}  // namespace nonio::model
