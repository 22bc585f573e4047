// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/thermal.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

/// What a thermal test followed over time.
namespace nonio::thermal {

enum class Test { etve, spindle, axis };

/// One sensor, or a tilt from two of them; zero at its first reading.
struct Followed {
  std::string name;    ///< X, Y1; of a tilt A (about X), B (about Y)
  math::Track run;     ///< of a spindle: from its start to its stop; else all
  math::Track cool;    ///< from the stop on, zero there; empty if it did not stop
  bool tilt = false;   ///< rad in place of m
  double lever = 0.0;  ///< of a tilt: distance of the sensors, m
};

struct Tracks {
  Test test = Test::etve;
  std::vector<Followed> all;
  std::vector<math::Visits> visits;  ///< of an axis
  bool speed_steps = false;
  std::vector<Finding> findings;
};

/// Sensors by their lines, cut where the spindle starts and stops; the visits of an axis.
Tracks tracks_of(const Measurement&, const Observations&);

}  // namespace nonio::thermal
