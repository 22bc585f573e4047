// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "nonio/model/fit.h"

namespace nonio::model {

/// Sets the weights of the candidates of one search from their frequencies. A candidate is named at
/// `weight` times the usual level (weighted Bonferroni test), and its evidence in the search is
/// larger by 2 ln(weight). The mean weight is at most 1, so that a search in noise names an effect
/// as rarely as without frequencies, however wrong they are. Source: Genovese, Roeder and
/// Wasserman, Biometrika 93 (2006) 509.
void set_weights(std::span<Term> candidates);

/// 2 ln(weight): what the frequency adds to the evidence of a candidate in the search. Printed
/// evidence excludes it.
double evidence_of_weight(double weight);

}  // namespace nonio::model
