// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/step_diagonals.h"
#include "nonio/sdk/results.h"
#include "passes.h"

namespace nonio::step_diagonal {

/// Puts points, a row a whole step: `target` along the diagonal and a column for each pass, by its
/// name; and D_max, the largest deviation there, with its U.
void put_whole_steps(const Passes&, const math::StepSolution&, const math::ReadingModel&,
                     math::BudgetOf*, Evaluation&);

}  // namespace nonio::step_diagonal
