// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/axis_test.h"
#include "nonio/math/uncertainty.h"
#include "nonio/sdk/plugin.h"

/// Functions shared by the analyses of an axis (ISO 230-2, VDI/DGQ 3441): an option, the selection
/// of the readings, the budget, and the findings that do not depend on the standard.
namespace nonio::math {

/// Returns the option `incomplete_targets`: how to treat targets that do not contribute to every
/// value.
Option incomplete_targets_option();

/// Input of an analysis: the readings that it evaluates, their budget and the findings common to
/// all standards.
struct AxisAnalysis {
  std::string axis;
  AxisTest test;
  std::optional<Budget> budget;
  std::size_t approaches = 0;  ///< smallest number of readings in a mean
  std::vector<Finding> findings;
  Quantity deviation = Quantity::deviation, position = Quantity::length;
};

/// Prepares an analysis. Error: the readings are not those of the measured axis, have no direction
/// of approach, or are angles for a linear axis or lengths for a rotary one.
Expected<AxisAnalysis> begin_axis_analysis(const AnalysisInput&);

/// Contributions to the uncertainty of a value: the whole budget, or only those that do not cancel
/// in a difference.
enum class Made { of_all, of_environment };

/// Adds a value, with U if the budget is known and U is above 0. The contributions to U are then
/// recorded in the budget. A value that is not finite is omitted.
void add_value(Evaluation&, const AxisAnalysis&, std::string name, double value, double U, Made);

}  // namespace nonio::math
