// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "nonio/sdk/error.h"

/// Predicted uncertainties of a rotary axis for a plan of ball positions, before the measurement.
///
/// N equal steps over an arc of radius R; every coordinate of a center has the independent standard
/// uncertainty sigma. For a full turn, from the covariance of the fit:
///
///     across the axis, each   sigma sqrt(2/N)     along it   sigma/sqrt N    (both without R)
///     tilt, each              sigma sqrt(2/N)/R
///
/// Two positions half a turn apart determine the center with sigma/sqrt 2 in each coordinate, and
/// no direction. Derived (docs/dev/estimators.md).
namespace nonio::math {

struct RotaryPlan {
  std::size_t balls = 4;
  double radius = 0.5;  ///< distance of the ball from the axis, m
  /// angle covered by the positions, rad; a full turn has equal steps without a position at its end
  double arc = 6.283185307179586;
  double sigma = 1e-6;
};

/// Uncertainty of the fitted axis relative to the true one; m, rad.
struct RotaryPlanU {
  double across = 0.0;  ///< largest standard uncertainty perpendicular to the axis
  double along = 0.0;
  double centre_rms = 0.0;  ///< root mean square distance between fitted and true center
  double centre_mean = 0.0;
  double tilt = 0.0;           ///< largest standard uncertainty of the tilt, over all directions
  double direction_rms = 0.0;  ///< root mean square angle between fitted and true axis
  double direction_mean = 0.0;
};

/// Each simulated measurement is evaluated by fit_rotary. Errors: fewer than 3 or more than 10000
/// balls, an invalid or too short arc, a radius of at most 100 sigma, fewer than 10 trials.
Expected<RotaryPlanU> simulated(const RotaryPlan&, std::size_t trials, std::uint64_t seed);
/// Uses the covariance of the fit; centre_mean and direction_mean are 0. Errors: those of
/// `simulated`, except for the trials.
Expected<RotaryPlanU> expected_of(const RotaryPlan&);

/// Smallest number of balls with which 2 u of the center (across), m, and of the direction (tilt),
/// rad, are within these limits (0: no limit). Error: `most` balls are too few.
Expected<std::size_t> cheapest(RotaryPlan, double U_centre, double U_direction,
                               std::size_t most = 360);

}  // namespace nonio::math
