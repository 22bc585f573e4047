// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/step_diagonals.h"
#include "nonio/sdk/plugin.h"

/// What the observations of a campaign give to the kernel of step diagonals.
namespace nonio::step_diagonal {

/// The passes of a measurement, or the finding that states why they cannot be evaluated together.
struct Passes {
  math::StepDiagonals readings;
  std::vector<std::string> axes;   ///< their names along X, Y, Z
  std::vector<std::string> names;  ///< of the passes: "SD PPP"
  std::vector<Finding> refusal;
};
Expected<Passes> passes_of(const AnalysisInput& in);

/// The axis measurements of the campaign that go along its axes.
struct Lengths {
  std::vector<math::AxisSeries> series;
  std::vector<std::string> ids;  ///< of the measurements, one for each series
  std::vector<Finding> findings;
};
Lengths lengths_of(const AnalysisInput& in, const Passes& passes);

/// Passes and series as their budget needs them, in the order of solve_step_diagonals.
std::vector<math::BudgetLine> budget_lines(const Passes&, const Lengths&, const Campaign&);
/// What yaw and pitch of each axis, within +-angle (rad), make in the readings of the passes:
/// shapes that are linear and quadratic over the travel, half of the variance each.
math::ReadingModel::Input angles_input(const Passes&, const math::ReadingModel&, double angle);
/// The measurement and those of its lengths.
std::vector<const Observations*> observations_of(const AnalysisInput&, const Lengths&);

}  // namespace nonio::step_diagonal
