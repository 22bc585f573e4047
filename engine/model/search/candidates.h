// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.h"
#include "fit/compare.h"
#include "nonio/model/explain.h"

namespace nonio::model {

/// Every effect outside the model, most evidence first. Effects of a library are omitted unless
/// they are or could replace a member of the best explanation. `ground`: weights and noise.
std::vector<Candidate> candidates_of(const Finding& finding, const Ground& ground);

/// Effects of the model that others can replace with hardly any loss of evidence, with the names of
/// these.
std::vector<Replaceable> replaceable_in(const Finding& finding, const Ground& ground);

/// Candidates with evidence alone come first: the others show only next to further effects, and do
/// not reduce the RMS as the first addition to the model. Their `score` is limited by those before.
void rank(std::vector<Candidate>& candidates);

}  // namespace nonio::model
