// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/plugin.h"

namespace nonio::heidenhain_tnc {

/// The axis' .COM under the name that CONFIG.CMA has for it; its cell there, if it was empty.
Expected<std::vector<Artifact>> merge(const MergeInput& in);

}  // namespace nonio::heidenhain_tnc
