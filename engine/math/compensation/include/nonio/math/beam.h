// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"

/// What tables of both sides of a gantry do to its beam.
namespace nonio::math {

/// The beam of a gantry, which is rigid: a motion of one side is distributed along it.
///
///     share(y) = 1 - (y - y_axis)/(y_slave - y_axis)        of the axis; of the slave 1 - share
///     x moves by share c_axis + (1 - share) c_slave         m
///     the beam turns by (c_slave - c_axis)/(y_slave - y_axis)
///
/// y: position along the beam; those of the sides are where their lines were measured (`at`).
/// Source: statics of a rigid body.
struct Beam {
  std::string axis, slave;
  /// the axis along the beam; empty: the positions of the sides are not stated
  std::string along{};
  double at_axis = 0.0, at_slave = 0.0;
};

/// Returns a beam for each axis with a slave.
std::vector<Beam> beams_of(const Campaign&);

using Places = std::map<std::string, double>;
using MotionSigns = std::map<std::string, int>;

/// Returns what is added to `axis` at this position, m or rad. `side` returns what is added to one
/// axis, or to one side of a gantry. Nothing if that depends on the positions of a gantry's sides
/// and they are not stated.
std::optional<double> added_on_beam(
    const std::vector<Beam>& beams, const std::string& axis, Places at, MotionSigns direction,
    const std::function<double(const std::string&, const Places&, const MotionSigns&)>& side);

}  // namespace nonio::math
