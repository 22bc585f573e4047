// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "nonio/math/rotary.h"
#include "nonio/sdk/plugin.h"

namespace nonio::rotary_kinematics {

/// Options of the user, in SI units; absent if not stated.
struct Wish {
  bool use_angles = false;
  std::optional<double> sigma;         ///< standard uncertainty of one coordinate of a reading
  std::optional<double> linear_axes;   ///< bound of squareness and scale difference, rad
  std::optional<double> U_instrument;  ///< k = 2, of a length as large as the circle
  double tolerance = 0.0;              ///< largest accepted U of the center, m
  double tolerance_direction = 0.0;    ///< largest accepted U of the direction, rad
  double circle_limit = 10.0;          ///< largest accepted residuals, in multiples of sigma
};

/// A fitted axis with its uncertainty, or the findings that explain why it is refused.
struct Judged {
  std::vector<math::BallCentre> centres;
  bool given = false;   ///< whether there is a result; otherwise the findings state the reason
  bool U_known = true;  ///< false with three points if inputs of U are missing
  math::RotaryFit fit;
  double sigma = 0.0;             ///< standard uncertainty of one coordinate
  double dof = INFINITY;          ///< of sigma; infinite if it is stated
  bool sigma_of_centres = false;  ///< whether sigma is the u stated with the centers
  double k = 2.0;                 ///< coverage factor for 95 %
  double U_shear = 0.0;           ///< U in the plane from the bound `linear_axes`
  std::vector<Finding> findings;

  /// Standard uncertainties by repetition.
  double u_centre(std::size_t coordinate) const;
  double u_direction(std::size_t coordinate) const;
  double u_radius() const;
};

Judged judge(const Observations&, const Wish&);

}  // namespace nonio::rotary_kinematics
