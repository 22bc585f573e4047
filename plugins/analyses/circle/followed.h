// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

namespace nonio::circle {

/// States what of a circle's values is followed: another way to measure, so other quantities than
/// those of runs and diagonals. What is not linear in the readings (G, H, F, amplitudes, spikes) is
/// not followed. Circles are compared at one place, with one radius and one feed.
void follow(const Campaign&, const Measurement&, Evaluation&);

}  // namespace nonio::circle
