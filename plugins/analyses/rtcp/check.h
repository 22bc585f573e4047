// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/math/rtcp.h"
#include "nonio/sdk/plugin.h"

namespace nonio::rtcp {

/// Options of the user, in SI units; absent if not stated.
struct Wish {
  std::optional<bool> head;           ///< whether the axis carries the tool
  std::optional<double> sigma;        ///< standard uncertainty of a reading
  std::optional<double> linear_axes;  ///< bound of squareness and scale difference, rad
  std::optional<double> U_ball;       ///< U of each coordinate of the ball position, k = 2
  double tolerance = 0.0, tolerance_direction = 0.0;
};

/// Errors of the axis parameters of the control from one measurement, or why they are refused.
struct Checked {
  bool given = false;
  std::vector<math::RtcpReading> readings;  ///< sorted by line
  std::vector<std::size_t> row;             ///< row of each reading in the observations
  math::RtcpFit fit;
  double sigma = 0.0, dof = INFINITY;
  math::ReadingModel model;
  std::vector<Finding> findings;
  std::string names[4];  ///< of the values: centre_error_x, ..., direction_error_i

  double u_repetition(std::size_t value) const;
  /// Whether the readings determine the value with a U within the tolerance.
  bool is_identifiable(std::size_t value) const {
    return given && fit.identifiable[value] && wide[value] == 0.0;
  }
  double wide[4] = {0.0, 0.0, 0.0, 0.0};  ///< U if above the tolerance, otherwise 0
};

Checked check(const Campaign&, const Observations&, const std::string& axis, const Environment&,
              const Wish&);

/// Combined standard uncertainty of each value.
std::array<double, 4> whole_u(const Checked&);

}  // namespace nonio::rtcp
