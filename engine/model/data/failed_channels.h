// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Removes values that thermometers return after power-on, single readings far from those around
/// them, and channels of thermometers that fail for a notable part of the time, and stores the
/// reasons in `channels_left`.
void leave_failed(Part& part);

}  // namespace nonio::model
