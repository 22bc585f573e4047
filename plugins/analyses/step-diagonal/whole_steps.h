// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/step_diagonals.h"
#include "nonio/sdk/results.h"
#include "passes.h"

namespace nonio::step_diagonal {

/// A pass at whole steps of all three axes, from its start on.
struct WholeSteps {
  std::vector<double> deviation;  ///< m; NaN: not read
  std::vector<double> left;       ///< less what the curves and squarenesses say; empty: not known
};
/// Of each pass; `left` where every curve is known.
std::vector<WholeSteps> whole_steps(const math::StepDiagonals&, const math::StepSolution*);

/// A row a whole step: `target` along the diagonal, a column for each pass, by its name; and what
/// would be left after tables of the curves, `left PPP`.
PointTable whole_step_table(const Passes&, const std::vector<WholeSteps>&);

/// The largest in size, and where.
struct LargestStep {
  double value = 0.0;
  std::size_t pass = 0, step = 0;
};
LargestStep largest_step(const std::vector<WholeSteps>&, bool left);

/// Puts points, the largest deviation D_max with its U, and D_left, the largest that is left.
void put_whole_steps(const Passes&, const math::StepSolution&, const math::ReadingModel&,
                     math::BudgetOf*, Evaluation&);

}  // namespace nonio::step_diagonal
