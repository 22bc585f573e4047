// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "nonio/math/spindle.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

/// Turns of each sensor, by how the ball stood on the spindle and where the sensors stood.
namespace nonio::spindle {

struct Place {
  double ball = 0.0, sensor = 0.0;  ///< rad, to a thousandth of a degree
  auto operator<=>(const Place&) const = default;
};

struct SetUps {
  std::map<std::string, std::map<Place, math::Turns>> of;  ///< by the sensor: X, Y1, ...
  std::vector<Finding> findings;                           ///< sensors that gave no turns
  bool resampled = false;
};

SetUps set_ups_of(const Observations&);

/// Error separation: of the places of one sensor, a pair turned by half a turn, or the ball all
/// round in even steps.
struct Separation {
  enum class Kind { none, donaldson, multi_step } kind = Kind::none;
  std::vector<Place> places;  ///< of a pair the first one stands as its values are given
};
Separation separation_of(const std::map<Place, math::Turns>&);

}  // namespace nonio::spindle
