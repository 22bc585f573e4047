// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "nonio/math/rotary.h"
#include "nonio/sdk/plugin.h"

namespace nonio::rotary_kinematics {

/// What the user requires and knows; SI.
struct Wish {
  bool use_angles = false;
  std::optional<double> sigma;         ///< of one coordinate of one reading, stated
  std::optional<double> linear_axes;   ///< bound of squareness and scale difference, rad
  std::optional<double> U_instrument;  ///< k = 2, of a length as large as the circle
  double tolerance = 0.0;              ///< for U of the centre, m
  double tolerance_direction = 0.0;    ///< for U of the direction, rad
  double circle_limit = 10.0;          ///< residuals beyond this many sigma are no circle
};

/// A fitted axis with its uncertainty, or the reason why there is none.
struct Judged {
  std::vector<math::BallCentre> centres;
  bool given = false;   ///< else refused, and the findings state why
  bool U_known = true;  ///< else three points without what their uncertainty follows from
  math::RotaryFit fit;
  double sigma = 0.0;             ///< standard uncertainty that the covariance is scaled with
  double dof = INFINITY;          ///< of sigma; infinite if it is stated
  bool sigma_of_centres = false;  ///< it is what the centres state of themselves
  double k = 2.0;                 ///< expands it to 95 %
  double U_shear = 0.0;           ///< in the plane, from the bound of the linear axes
  std::vector<Finding> findings;

  /// Standard uncertainties that the repetition makes.
  double u_centre(std::size_t coordinate) const;
  double u_direction(std::size_t coordinate) const;
  double u_radius() const;
};

Judged judge(const Observations&, const Wish&);

}  // namespace nonio::rotary_kinematics
