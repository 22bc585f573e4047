// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/observations.h"

namespace nonio::model {

/// Tables longer than this are searched in a shorter form.
inline constexpr std::size_t thin_beyond = 6000;

/// Means of readings that lie close together: of one line and direction, of neighbouring runs and
/// neighbouring positions. The noise of a mean is smaller; what varies slowly stays.
Observations thinned(const Observations& o);

}  // namespace nonio::model
