// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::twincat_cnc {

/// Replaces kw.ssfk in the list of the axis; other content such as kw.crosscomp is kept.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::twincat_cnc
