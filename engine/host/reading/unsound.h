// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/observations.h"

namespace nonio::host::reading {

/// What every later stage relies on, whatever the reader did: columns of one length, numbers, lines
/// that exist. Empty, or what is wrong.
std::string unsound(const Observations& o);

}  // namespace nonio::host::reading
