// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "nonio/model/explain.h"

namespace nonio::model {

std::vector<double> weights_without(std::size_t readings, const std::vector<Suspect>& suspects);

/// The comparison with these readings suspected, around a fit that is there already.
Comparison comparison_of(const Part& part, const Repeats& repeats, Fit fit,
                         std::vector<Suspect> suspects);

/// Of each term whether its shapes are searched.
std::vector<char> searched_in(const std::vector<Term>& terms);

/// The fit anew, where its zero walks or is another one in each run.
Expected<Fit> with_its_zero(const Observations& o, Fit fitted, const std::vector<char>& searched);

/// The comparison with these readings suspected; no places of a long table.
Expected<Comparison> compare_without(const Part& part, const std::vector<Term>& model,
                                     const Repeats& repeats, std::vector<Suspect> suspects);

/// Where what a fit leaves sits.
std::vector<Place> seats_in(const Part& part, const Repeats& repeats, const Comparison& comparison);

/// Each run left out in turn: what the others, with the shapes as they are, predict of it. NaN for
/// readings of a run that the others cannot predict; empty with one run.
std::vector<double> cross_validated(const Observations& o, const std::vector<Term>& terms,
                                    const std::vector<double>& weight);
/// Root of the weighted mean square of what can be predicted.
std::optional<double> rms_of(const std::vector<double>& residual,
                             const std::vector<double>& weight);

}  // namespace nonio::model
