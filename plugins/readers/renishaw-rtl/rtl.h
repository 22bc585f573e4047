// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::renishaw {

/// Reads linear measurements (.rtl) of a laser interferometer.
Reader rtl_reader();

}  // namespace nonio::renishaw
