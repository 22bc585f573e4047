// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/math/rtcp.h"
#include "nonio/sdk/plugin.h"

namespace nonio::rtcp {

/// What the user requires and knows; SI.
struct Wish {
  std::optional<bool> head;           ///< the axis carries the tool; none: not stated
  std::optional<double> sigma;        ///< standard uncertainty of a reading, stated
  std::optional<double> linear_axes;  ///< bound of squareness and scale difference, rad
  std::optional<double> U_ball;       ///< of the ball's place, each coordinate, k = 2
  double tolerance = 0.0, tolerance_direction = 0.0;
};

/// One measurement: what it determines of the control's axis, or why it does not.
struct Checked {
  bool given = false;
  std::vector<math::RtcpReading> readings;  ///< by line
  std::vector<std::size_t> row;             ///< of the observations, of each reading
  math::RtcpFit fit;
  double sigma = 0.0, dof = INFINITY;
  math::ReadingModel model;
  std::vector<Finding> findings;
  std::string names[4];  ///< of the values: centre_error_x, ..., direction_error_i

  double u_repetition(std::size_t value) const;
  /// Whether the readings, and the uncertainty that is required, give it.
  bool is_identifiable(std::size_t value) const {
    return given && fit.identifiable[value] && wide[value] == 0.0;
  }
  double wide[4] = {0.0, 0.0, 0.0, 0.0};  ///< U that is above the tolerance; 0: it is not
};

Checked check(const Campaign&, const Observations&, const std::string& axis, const Environment&,
              const Wish&);

/// Standard uncertainty of each value, all of it.
std::array<double, 4> whole_u(const Checked&);

}  // namespace nonio::rtcp
