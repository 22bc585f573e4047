// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "search/finding.h"

namespace nonio::model {

/// What the model and the effects that are certain leave, by descriptions: one after the other, the
/// best first, as long as the evidence pays for their columns.
std::vector<Description> described(const Finding& finding, const std::vector<Term>& certain);

/// Whether the term says the same of all readings of a target from one side.
bool of_place(const Finding& finding, const Term& term);

}  // namespace nonio::model
