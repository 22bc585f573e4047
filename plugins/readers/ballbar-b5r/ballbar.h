// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::ballbar {

/// Header and results of Renishaw's Ballbar 20 (.b5r), as notes.
Reader reader();

}  // namespace nonio::ballbar
