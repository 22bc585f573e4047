// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "places.h"

namespace nonio::rotary_chain {

/// Names with commas between them.
std::string listed(const std::vector<std::string>& names);

/// What the user requires and knows; SI.
struct Wish {
  std::optional<double> sigma;        ///< standard uncertainty of a coordinate, stated
  std::optional<double> linear_axes;  ///< bound of squareness and scale difference, rad
  std::optional<double> offset;       ///< nominal distance of the axes, m
  std::optional<double> U_tool;       ///< of the stated length of a tool, k = 2, m
  double tolerance = 0.0, tolerance_direction = 0.0;
  double circle_limit = 10.0;  ///< residuals beyond this many sigma are no chain
};

/// The fitted chain, or why there is none.
struct Solved {
  bool given = false;
  math::ChainFit fit;
  double sigma = 0.0, dof = INFINITY;
  bool from_readings = false;  ///< sigma: from the residuals, or stated by the reader
  /// Derivatives of the residuals that the scatter is taken from; empty where they were not made.
  std::vector<std::vector<double>> residual_by;
  std::vector<Finding> findings;
};
/// The scatter is that of the residuals without what squareness and scales of the linear axes make
/// in them, if the model has a bound of these: it has a line of its own in the budget.
Solved solve(const AnalysisInput&, const Chain&, const Places&, const Wish&,
             const math::ReadingModel&);

/// One value that may be given.
struct Candidate {
  std::string name;
  Quantity quantity = Quantity::length;
  math::ChainValue value;
  double by_tool = 0.0;  ///< derivative by the stated length of the tool
  bool is_direction() const { return quantity != Quantity::length; }
};
/// All values of the chain, identifiable or not, in the order in which they are given.
std::vector<Candidate> candidates(const Chain&, const Places&, const math::ChainFit&);
/// What the two longest stated tools show of their axis.
struct Tools {
  bool two = false;              ///< two stated ones of different length
  std::size_t from = 0, to = 0;  ///< the shorter and the longer
  double stated = 0.0;           ///< difference of their lengths, m
};
Tools tools_of(const Places&);
double tool_length(const Measurement&);

}  // namespace nonio::rotary_chain
