// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::renishaw {

/// Angular measurements (.rta), once the user has confirmed their unit and sign.
Reader rta_reader();

}  // namespace nonio::renishaw
