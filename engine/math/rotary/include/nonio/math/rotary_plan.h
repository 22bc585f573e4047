// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "nonio/sdk/error.h"

/// Uncertainties that the balls of a plan will give for a rotary axis, before the measurement.
///
/// N equal steps over an arc of radius R; every coordinate of a centre has the independent standard
/// uncertainty sigma. On a full turn, from the covariance of the fit:
///
///     across the axis, each   sigma sqrt(2/N)        along it   sigma/sqrt N     (no R in either)
///     tilt, each              sigma sqrt(2/N)/R
///
/// Two positions half a turn apart give a centre with sigma/sqrt 2 each way and no direction.
/// Derived, docs/formulas.md; the figures for R = 500, 50 and N = 3, 4, 5, 10 are golden.
namespace nonio::math {

struct RotaryPlan {
  std::size_t balls = 4;
  double radius = 0.5;             ///< m
  double arc = 6.283185307179586;  ///< rad; a full turn: equal steps without the last place
  double sigma = 1e-6;             ///< of a coordinate, m
};

/// Of the axis that the fit finds, less the true one; m, rad.
struct RotaryPlanU {
  double across = 0.0;         ///< standard uncertainty of the worse coordinate across the axis
  double along = 0.0;          ///< of the one along it
  double centre_rms = 0.0;     ///< root mean square of the distance in space
  double centre_mean = 0.0;    ///< mean distance in space
  double tilt = 0.0;           ///< standard uncertainty of the worse tilt
  double direction_rms = 0.0;  ///< of the angle between found and true axis
  double direction_mean = 0.0;
};

/// By so many simulated measurements, each evaluated by fit_rotary. Errors: fewer than three
/// balls, an arc that is none, a radius not far above sigma.
Expected<RotaryPlanU> simulated(const RotaryPlan&, std::size_t trials, std::uint64_t seed);
/// The same by the covariance of the fit, without the means, which stay 0.
Expected<RotaryPlanU> expected_of(const RotaryPlan&);

/// The fewest balls with which 2 u of the centre (across) and of the direction (tilt) are not above
/// these limits (0: none), or nothing if `most` balls do not reach them.
Expected<std::size_t> cheapest(RotaryPlan, double U_centre, double U_direction,
                               std::size_t most = 360);

}  // namespace nonio::math
