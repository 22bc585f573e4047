// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::renishaw {

/// Linear measurements of a laser interferometer, as its program stores them (.rtl).
Reader rtl_reader();

}  // namespace nonio::renishaw
