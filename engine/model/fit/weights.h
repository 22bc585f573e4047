// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "nonio/model/fit.h"

namespace nonio::model {

/// An effect is named if the probability of such evidence by noise, anywhere in the search, is
/// below this value: docs/dev/constants.md, M2.
inline constexpr double named_below = 0.005;

/// Sets the weights of the candidates of one search from their frequencies, and from the gain that a
/// larger weight brings if they have their usual sizes: none if these are far above the limit of
/// detection, or far below it. `u`: standard uncertainty of the RMS of an effect, m or rad, from the
/// noise and the number of readings; 0: sizes do not count. A candidate is named at
/// `weight` times the usual level (weighted Bonferroni test), and its evidence in the search is
/// larger by 2 ln(weight). The mean weight is at most 1, so that a search in noise names an effect
/// as rarely as without frequencies and sizes, however wrong they are. Sources: Genovese, Roeder and
/// Wasserman, Biometrika 93 (2006) 509; Roeder and Wasserman, Statistical Science 24 (2009) 398.
void set_weights(std::span<Term> candidates, double u);

/// 2 ln(weight): what frequency and size add to the evidence of a candidate in the search. Printed
/// evidence excludes it.
double evidence_of_weight(double weight);

/// Probability that a standard normal variable is below x.
double normal_below(double x);

}  // namespace nonio::model
