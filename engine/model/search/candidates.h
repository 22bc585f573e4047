// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.h"

namespace nonio::model {

/// Every effect outside the model, with its evidence, its aliases and the smallest that would be
/// found; most evidence first.
std::vector<Candidate> candidates_of(const Finding& finding);

}  // namespace nonio::model
