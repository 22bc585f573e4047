// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/thermal.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

namespace nonio::thermal {

/// `loaded`: a speed or load was recorded as a channel, so the machine was not at rest.
enum class Test { etve, loaded, spindle, axis };

/// One sensor, or a tilt from two sensors; 0 at its first reading.
struct Followed {
  std::string name;    ///< X, Y1; for a tilt A (about X) or B (about Y)
  math::Track run;     ///< from start to stop of a spindle, otherwise the whole test
  math::Track cool;    ///< from the stop on, 0 at the stop; empty without a stop
  bool tilt = false;   ///< whether values are in rad instead of m
  double lever = 0.0;  ///< distance of the sensors of a tilt, m
};

struct Tracks {
  Test test = Test::etve;
  std::vector<Followed> all;
  std::vector<math::Visits> visits;  ///< readings of an axis test by position
  bool speed_steps = false;
  Quantity deviation = Quantity::deviation;  ///< of the sensors; angular_deviation: tilts in rad
  std::vector<Finding> findings;
};

/// Displacement of each sensor, divided at start and stop of a spindle; for an axis test, its
/// visits of the targets.
Tracks tracks_of(const Measurement&, const Observations&);

}  // namespace nonio::thermal
