// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/step_diagonals.h"
#include "nonio/sdk/plugin.h"

namespace nonio::step_diagonal {

/// The passes of a measurement, or the findings that explain why they cannot be evaluated.
struct Passes {
  math::StepDiagonals readings;
  std::vector<std::string> axes;   ///< along X, Y, Z
  std::vector<std::string> names;  ///< such as "SD PPP"
  std::vector<Finding> refusal;
};
Expected<Passes> passes_of(const AnalysisInput& in);

/// The positioning measurements of the campaign along the axes of the passes.
struct Lengths {
  std::vector<math::AxisSeries> series;
  std::vector<std::string> ids;  ///< one measurement per series
  std::vector<Finding> findings;
};
Lengths lengths_of(const AnalysisInput& in, const Passes& passes);

/// Budget lines of the passes, then of the positioning measurements, as in solve_step_diagonals.
std::vector<math::BudgetLine> budget_lines(const Passes&, const Lengths&, const Campaign&);
/// Effect of yaw and pitch of each axis, within +-angle (rad), on the passes. Linear and quadratic
/// shapes over the travel have half of the variance each.
math::ReadingModel::Input angles_input(const Passes&, const math::ReadingModel&, double angle);
std::vector<const Observations*> observations_of(const AnalysisInput&, const Lengths&);

}  // namespace nonio::step_diagonal
