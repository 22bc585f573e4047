// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"

namespace nonio::model {

/// What may be wrong with the parts of `terms` since blank temperatures are interpolated: columns,
/// n rows each, m or rad, independent of each other and of one standard uncertainty each. How far
/// the straight line goes wrong is measured where temperatures are known, over stretches as long as
/// the gap. `linear` holds the linear parameters of each term. None where nothing is interpolated
/// or no term uses it; an error if too few temperatures are known for it.
Expected<MatrixXd> wrong_by_interpolation(const Observations& o, const std::vector<Term>& terms,
                                          const std::vector<VectorXd>& linear);

}  // namespace nonio::model
