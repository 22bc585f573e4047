// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.h"
#include "fit/compare.h"
#include "nonio/model/explain.h"

namespace nonio::model {

/// Every effect outside the model, most evidence first. Effects of a library are omitted unless
/// they are or could replace a member of the best explanation. `ground`: weights and noise.
std::vector<Candidate> candidates_of(const Finding& finding, const Ground& ground);

}  // namespace nonio::model
