// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "design.h"
#include "nonio/model/comparison.h"
#include "repeats.h"

/// Estimates the correlation of the noise from the residuals of repeats (docs/model.md).
namespace nonio::model {

/// Returns the smallest difference between two readings, m or rad, if all differences are integer
/// multiples of it, within 2 %. Returns 0 otherwise, or if the range of the readings exceeds 10^6
/// such steps.
double digit_of(const Observations& o);

/// Returns the weights divided by the square of the relative scatter `rough` of each reading.
std::vector<double> with_scatter(const std::vector<double>& weight, const Noise& noise);

/// Estimates, from the residuals of repeats alone, the range of targets with a different scatter
/// and the correlation of adjacent readings. No model of the catalogue is used.
Noise noise_of(const Part& part, const Repeats& repeats, const std::vector<double>& weight);

/// Returns the scatter of repeats with the weights of `with_scatter`, at least digit/sqrt(12). The
/// pass terms of `saturate` absorb a part of the correlation of adjacent readings; the result is
/// corrected for this. None if there are fewer than 3 degrees of freedom.
std::optional<NoiseFloor> noise_floor(const Repeats& repeats, const Saturated& saturated,
                                      const std::vector<double>& weight, const Noise& noise);

/// Returns `noise` with a random zero, or with a stronger correlation of adjacent readings, if this
/// makes the residuals of these terms (with their shapes) more likely: restricted likelihood
/// (Patterson and Thompson 1971), maximized over kinds and sizes. Returns `noise` unchanged for
/// fewer than 10 or more than 1500 readings, if the passes are not known, or if the redundancy is
/// below 3.
Noise with_zero(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight, const Noise& noise);

/// Minimum over the size of a random zero of n ln(squares/n) + ln|V| for a model together with this
/// zero: `Workbench::State::criterion` without its penalty.
struct Unsteady {
  /// minimum for a zero that is a random walk from row to row
  double walks = std::numeric_limits<double>::infinity();
  /// minimum for a random zero of each run; infinite with one run
  double of_run = std::numeric_limits<double>::infinity();
  /// minimum for a random zero of each pass; infinite if the passes are not known
  double of_pass = std::numeric_limits<double>::infinity();
  double size_of_pass = 0.0;  ///< size of the zero of a pass, in units of s
  double least() const { return std::min(walks, of_run); }
};
/// Computes the criterion for each kind of random zero. `model`: the model's columns, in the order
/// of the rows; rows of weight 0 are ignored.
Unsteady walk_with(const Observations& o, const std::vector<double>& weight, Noise noise,
                   const MatrixXd& model);

/// Returns the criterion with correlated adjacent readings and a constant zero, minimized over the
/// correlation; ln|V| is relative to independent readings.
double criterion_of_neighbours(const Observations& o, const std::vector<double>& weight,
                               Noise noise, const MatrixXd& model);

}  // namespace nonio::model
