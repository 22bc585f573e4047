// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "design.h"
#include "nonio/model/comparison.h"
#include "repeats.h"

namespace nonio::model {

/// Smallest difference between two readings, m or rad, if all differences are multiples of it
/// within 2 %; 0 otherwise, or if the range of the readings exceeds 10^6 such steps.
double digit_of(const Observations& o);

/// Returns the weights divided by the square of the relative scatter `rough` of each reading.
std::vector<double> with_scatter(const std::vector<double>& weight, const Noise& noise);

/// Range of targets with another scatter, and correlation of adjacent readings, from repeats alone.
Noise noise_of(const Part& part, const Repeats& repeats, const std::vector<double>& weight);

/// Scatter of repeats, at least digit/sqrt(12), corrected for the part of the correlation that the
/// pass terms of `saturate` absorb. std::nullopt with fewer than 3 degrees of freedom.
std::optional<NoiseFloor> noise_floor(const Repeats& repeats, const Saturated& saturated,
                                      const std::vector<double>& weight, const Noise& noise);

/// Adds a random zero, or a stronger correlation of adjacent readings, if the residuals are then
/// more likely: restricted likelihood (Patterson and Thompson 1971), maximized over kinds and
/// sizes. Unchanged for under 10 or over 1500 readings, unknown passes, or a redundancy below 3.
Noise with_zero(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight, const Noise& noise);

/// Minimum over the size of a random zero of n ln(squares/n) + ln|V| for a model together with this
/// zero: `Workbench::State::criterion` without its penalty.
struct Unsteady {
  double walks = std::numeric_limits<double>::infinity();   ///< random walk from row to row
  double of_run = std::numeric_limits<double>::infinity();  ///< for each run; infinite with one run
  double of_pass = std::numeric_limits<double>::infinity();  ///< for each pass; infinite if unknown
  double size_of_pass = 0.0;  ///< size of the zero of a pass, in units of s
  double least() const { return std::min(walks, of_run); }
};
/// `model`: columns, in the order of the rows; rows of weight 0 are ignored.
Unsteady walk_with(const Observations& o, const std::vector<double>& weight, Noise noise,
                   const MatrixXd& model);

/// For correlated adjacent readings and a constant zero; ln|V| is relative to independent readings.
double criterion_of_neighbours(const Observations& o, const std::vector<double>& weight,
                               Noise noise, const MatrixXd& model);

}  // namespace nonio::model
