// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "nonio/model/explain.h"

/// How what an explanation leaves scatters: what no effect can be blamed for, or named beside.
namespace nonio::model {

/// Repeats of one target fall into two groups with nothing between them: no noise does that.
bool two_valued(const Repeats& repeats, const std::vector<double>& residual,
                const std::vector<double>& weight);

/// Each target read once from each of two sides, and one reading may be misread: whether targets
/// differ by more than their two sides do, with the best of them left out. Place "position", p
/// corrected for which is left out.
std::optional<Place> beside_a_misread_target(const Observations& o, const Repeats& repeats,
                                             const std::vector<double>& residual,
                                             const std::vector<double>& weight);

/// One run with a scatter of its own.
std::optional<Place> wild_run(const Observations& o, const Repeats& repeats,
                              const std::vector<double>& residual,
                              const std::vector<double>& weight);

/// n ln(squares/n) + ln|V| of the model beside a zero that walks, reading by reading, as far as
/// makes this least: what `Workbench::State::criterion` is without its price. `model` holds the
/// model's columns; rows in file order, of weight 0 are left out.
double criterion_of_walk(const Observations& o, const VectorXd& root_weight, const MatrixXd& model);

}  // namespace nonio::model
