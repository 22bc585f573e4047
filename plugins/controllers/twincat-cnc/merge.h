// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::twincat_cnc {

/// kw.ssfk in the list of the axis; whatever else the list holds, kw.crosscomp too, stays.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::twincat_cnc
