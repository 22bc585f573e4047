// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

/// Budgets of ranges over time or angle: differences of two readings of one stationary instrument.
///
/// Errors of the instrument that both readings share cancel. U_fixed is treated as a gain error
/// that reaches U_fixed at the largest deviation; for a beam, U_per_length is a change of its scale
/// between both readings. Drift is the measurand itself. The form error of a ball, of full range r,
/// contributes u = r/sqrt 3.
///
/// Source: JCGM 100:2008; the shared errors are a laboratory method (docs/uncertainty.md).
namespace nonio::math {

struct Difference {
  std::string name;
  double value = 0.0;
  Quantity quantity = Quantity::deviation;
  /// standard uncertainty by repetition; dof 0: not known, so U is not given
  double u = 0.0, dof = INFINITY;
  /// the two deviations from which the value is computed, m; of tilts (angular_deviation) rad
  double from = 0.0, to = 0.0;
  double scale = 0.0;      ///< value/(to - from); 0: the gain does not affect it
  double length = 0.0;     ///< length measured by a beam, m
  bool with_ball = false;  ///< whether the value contains the form error of the ball
};

/// Adds the values with U, the budget, and a finding about missing data. If instrument.sphere_um is
/// not stated, values that contain a ball have only a repeatability.
void put_differences(const Campaign&, const std::vector<Difference>&, Evaluation& out);

/// Returns a finding if all of at least four readings of a sensor are equal.
std::optional<Finding> dead_sensor(const std::string& name, std::span<const double> readings,
                                   Quantity of = Quantity::deviation);

}  // namespace nonio::math
