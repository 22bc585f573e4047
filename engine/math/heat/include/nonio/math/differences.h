// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

/// Budgets of what is a difference of two readings of one instrument that stays where it is: ranges
/// over time or angle.
///
/// What the instrument has in common for both readings drops out. Its U_fixed is an error of its gain
/// that reaches U_fixed at the largest deviation, so that a value has it by its own share; of a beam,
/// U_per_length is a change of its scale between both readings. Drift is what is measured. The form of
/// a ball, of full range r, changes a range by at most r: u = r/sqrt 3.
///
/// Source: JCGM 100:2008; which errors the instrument has in common is ours (docs/uncertainty.md).
namespace nonio::math {

struct Difference {
  std::string name;
  double value = 0.0;
  Quantity quantity = Quantity::deviation;
  double u = 0.0, dof = INFINITY;  ///< of the repetition; dof 0: not known, and no U
  double from = 0.0, to = 0.0;     ///< deviations whose difference it is, m
  double scale = 0.0;      ///< of the value by that difference; 0: the instrument's gain drops out
  double length = 0.0;     ///< measured by a beam, m
  bool with_ball = false;  ///< it holds the form of the ball
};

/// Values with U, the budget, and the finding of what was not stated. A value that includes the
/// form of a ball that is not stated (instrument.sphere_um) has its repeatability only.
void put_differences(const Campaign&, const std::vector<Difference>&, Evaluation& out);

}  // namespace nonio::math
