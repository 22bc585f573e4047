// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/math/rotary_chain.h"
#include "nonio/sdk/plugin.h"

namespace nonio::rotary_chain {

/// The order of the axes in the kinematic chain, from the options.
struct Chain {
  std::vector<std::string>
      axes;  ///< tables from the bed outwards, then heads from the bed outwards
  std::size_t tables = 0;
  bool is_head(std::size_t axis) const { return axis >= tables; }
};

/// The centers of all measurements with angles of both axes and one reference point.
struct Places {
  std::vector<math::ChainReading> readings;  ///< sorted by measurement and time
  math::ChainOrder order;
  std::vector<const Observations*> tables;  ///< readings of each measurement in `used`
  std::vector<std::string> used, left_out;  ///< ids of measurements, each with its own ball
  std::vector<const Measurement*> tools;    ///< the first measurement of each tool
  double stated_u = 0.0;                    ///< u of a center from its file, m; 0 if not stated
  std::vector<Finding> findings;
  bool sound = true;
};

/// Readings of several runs or directions at one position of both axes become one center, weighted
/// by their number. A position repeated in one run and direction is a finding.
Places places_of(const AnalysisInput&, const Chain&);

/// Compares the state of the machine and the adjustment ("before" or "after").
bool same_state(const Measurement&, const Measurement&);

std::string listed(const std::vector<std::string>& names);

/// Options of the user, in SI units; absent if not stated.
struct Wish {
  std::optional<double> sigma;        ///< standard uncertainty of a coordinate
  std::optional<double> linear_axes;  ///< bound of squareness and scale difference, rad
  std::optional<double> offset;       ///< nominal distance of the axes, m
  std::optional<double> U_tool;       ///< U of the stated tool length, k = 2, m
  double tolerance = 0.0, tolerance_direction = 0.0;
  double circle_limit = 10.0;  ///< largest accepted s, in multiples of sigma
};

/// The fitted chain, or the findings that explain why it is refused.
struct Solved {
  bool given = false;
  math::ChainFit fit;
  double sigma = 0.0, dof = INFINITY;
  bool from_readings = false;  ///< sigma is from residuals or from u of the centers, not an option
  /// Derivatives of the residuals used for the scatter; empty if not computed.
  std::vector<std::vector<double>> residual_by;
  std::vector<Finding> findings;
};
/// If the model has a bound for squareness and scales of the linear axes, their effects are removed
/// from the scatter, because the budget contains them separately.
Solved solve(const AnalysisInput&, const Chain&, const Places&, const Wish&,
             const math::ReadingModel&);

/// A value that is reported if it is identifiable.
struct Candidate {
  std::string name;
  Quantity quantity = Quantity::length;
  math::ChainValue value;
  double by_tool = 0.0;  ///< derivative with respect to the stated tool length
  bool is_direction() const { return quantity != Quantity::length; }
};
/// All values in report order, including those that are not identifiable.
std::vector<Candidate> candidates(const Chain&, const Places&, const math::ChainFit&);
/// The pair of tools with the largest difference of stated lengths.
struct Tools {
  bool two = false;              ///< whether two tools have different stated lengths
  std::size_t from = 0, to = 0;  ///< indices of the shorter and longer tool
  double stated = 0.0;           ///< difference of the lengths, m
};
Tools tools_of(const Places&);
double tool_length(const Measurement&);

}  // namespace nonio::rotary_chain
