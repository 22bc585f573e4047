// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/math/rotary.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

namespace nonio::rotary_kinematics {

/// The centres of a measurement by position of the axis, ascending: readings of several runs,
/// directions or turns at one position are one centre with their number as weight. A position that
/// stands twice in one run and direction is a finding.
tl::expected<std::vector<math::BallCentre>, Finding> centres_of(const Observations&);

}  // namespace nonio::rotary_kinematics
