// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/model/explain.h"
#include "search/finding.h"

namespace nonio::model {

/// What the readings of an axis show whatever repeats at each target from each side: a drift of the
/// zero, a reversal at every target. Each pass may have a zero of its own: they are tested against
/// that scatter. Empty where fewer than 3 passes repeat others.
std::vector<Statement> statements_of(const Finding& finding);

}  // namespace nonio::model
