// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "design.h"
#include "nonio/model/comparison.h"
#include "repeats.h"

/// Correlation of the noise, from the residuals of repeats (docs/model.md).
namespace nonio::model {

/// Largest step of which all readings are whole multiples from each other; 0 if there is none.
double digit_of(const Observations& o);

/// Weights of the readings with their scatter: `weight` over the square of `rough`.
std::vector<double> with_scatter(const std::vector<double>& weight, const Noise& noise);

/// The stretch of targets that scatters differently and the correlation of neighbours, both from
/// what the repeats leave: no model of the catalogue is in it.
Noise noise_of(const Part& part, const Repeats& repeats, const std::vector<double>& weight);

/// `saturated` with the weights of `with_scatter`. What passes share takes some of what neighbours
/// share with it; the floor is what it would be without.
std::optional<NoiseFloor> noise_floor(const Repeats& repeats, const Saturated& saturated,
                                      const std::vector<double>& weight, const Noise& noise);

/// `noise` with a zero that is not steady, or with other neighbours than repeats show, where what
/// these terms (their shapes given) leave is more likely so: restricted likelihood (Patterson and
/// Thompson 1971) over its kinds and sizes.
Noise with_zero(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight, const Noise& noise);

/// n ln(squares/n) + ln|V| of a model together with a zero that is not steady, minimised over its
/// size: `Workbench::State::criterion` without its price.
struct Unsteady {
  double walks = std::numeric_limits<double>::infinity();    ///< a zero that walks, row by row
  double of_run = std::numeric_limits<double>::infinity();   ///< each run has its own
  double of_pass = std::numeric_limits<double>::infinity();  ///< each run in one direction
  double size_of_pass = 0.0;                                 ///< of the latter, over s
  double least() const { return std::min(walks, of_run); }
};
/// `model` holds the model's columns; rows in their order, of weight 0 are left out.
Unsteady walk_with(const Observations& o, const std::vector<double>& weight, Noise noise,
                   const MatrixXd& model);

/// The criterion of neighbours that are alike, of a steady zero, with the correlation that makes it
/// least; 0 of |V| are the independent readings.
double criterion_of_neighbours(const Observations& o, const std::vector<double>& weight,
                               Noise noise, const MatrixXd& model);

}  // namespace nonio::model
