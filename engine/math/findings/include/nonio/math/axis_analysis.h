// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/axis_test.h"
#include "nonio/math/uncertainty.h"
#include "nonio/sdk/plugin.h"

/// What the analyses of an axis (ISO 230-2, VDI/DGQ 3441) share: the option, the readings to be
/// evaluated, the budget, and the findings that do not depend on the standard.
namespace nonio::math {

/// `incomplete_targets`: what to do with targets that do not give every value.
Option incomplete_targets_option();

/// What an analysis starts from: the readings that it evaluates, their budget and the findings that
/// all standards have in common.
struct AxisAnalysis {
  std::string axis;
  AxisTest test;
  std::optional<Budget> budget;
  std::size_t approaches = 0;     ///< behind each mean, at least
  std::vector<Finding> findings;  ///< the common ones
  Quantity deviation = Quantity::deviation, position = Quantity::length;
};

/// Fails if the measurement is not one of an axis with directions of approach.
Expected<AxisAnalysis> begin_axis_analysis(const AnalysisInput&);

/// What an uncertainty is made of: the whole budget, or what does not drop out of a difference.
enum class Made { of_all, of_environment };

/// Adds the value, with U if the budget is known, which notes it; a value that is not finite is
/// absent.
void add_value(Evaluation&, const AxisAnalysis&, std::string name, double value, double U, Made);

}  // namespace nonio::math
