// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/axis_test.h"
#include "nonio/math/uncertainty.h"
#include "nonio/sdk/plugin.h"

namespace nonio::math {

/// How to treat targets that do not contribute to every value: 'refuse' or 'leave-out'.
Option incomplete_targets_option();

/// The parts of an analysis that do not depend on the standard.
struct AxisAnalysis {
  std::string axis;
  AxisTest test;
  std::optional<Budget> budget;
  std::size_t approaches = 0;  ///< smallest number of readings in a mean
  std::vector<Finding> findings;
  Quantity deviation = Quantity::deviation, position = Quantity::length;
};

/// Errors: readings of another axis or unit (angles, lengths), or without a direction of approach.
Expected<AxisAnalysis> begin_axis_analysis(const AnalysisInput&);

/// Contributions to the uncertainty of a value: all, or those that do not cancel in a difference.
enum class Made { of_all, of_environment };

/// Omits a value that is not finite. Adds U, and its contributions to the budget of the evaluation,
/// if the budget is known and U is above 0.
void add_value(Evaluation&, const AxisAnalysis&, std::string name, double value,
               const ResultUncertainty& U, Made);

/// States what U of values with a standard deviation does not contain; `values`: their names.
void note_scatter(Evaluation&, const AxisAnalysis&, std::string values);

}  // namespace nonio::math
