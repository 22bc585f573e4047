// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.h"
#include "fit/compare.h"
#include "nonio/model/explain.h"

namespace nonio::model {

/// Every effect outside the model, with its evidence, its aliases and the smallest that would be
/// found; most evidence first. `ground`: of the comparison that adding the effect is judged by.
std::vector<Candidate> candidates_of(const Finding& finding, const Ground& ground);

}  // namespace nonio::model
