// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::renishaw {

/// Reads angular measurements (.rta) if the user states their unit and sign.
Reader rta_reader();

}  // namespace nonio::renishaw
