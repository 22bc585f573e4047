// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.h"
#include "fit/compare.h"
#include "nonio/model/explain.h"

namespace nonio::model {

/// Returns every effect outside the model, with its evidence, its aliases and the smallest size
/// that would be detected; most evidence first. Effects of a library are omitted unless they are in
/// the best explanation or could replace a member of it. `ground`: weights and noise with which the
/// candidates are fitted.
std::vector<Candidate> candidates_of(const Finding& finding, const Ground& ground);

}  // namespace nonio::model
