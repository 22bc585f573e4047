// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "finding.h"

namespace nonio::model {

/// What the best explanation leaves, by descriptions: one after the other, the best first, as long
/// as the evidence pays for their columns.
std::vector<Description> described(const Finding& finding);

}  // namespace nonio::model
