// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "nonio/sdk/results.h"

/// The numbers behind the pictures of residuals. SI.
namespace nonio::pdf_report {

/// A curve, or points.
struct Trace {
  std::vector<double> x, y;
};

/// Readings that count: their weight says that they are no suspected misreading.
bool counts(const ModelFit&, std::size_t row);

/// Mean residual of the readings of one direction at each target.
Trace mean_by_target(const ModelFit&, int direction);

/// Mean residual in each of up to 12 equal parts of the range of x that hold three readings or
/// more.
Trace mean_by_part(const ModelFit&, const std::vector<double>& x);

/// Mean residual of each run.
Trace mean_by_run(const ModelFit&);

/// mean(+) - mean(-) of the residuals at each target that has both.
struct Reversal {
  Trace values;
  std::vector<double> spread;  ///< standard deviations in it per one of a reading
};
Reversal reversal_of(const ModelFit&);

/// Position within one period, 0 <= phase < period, of each reading.
std::vector<double> phase_of(const ModelFit&, double period);

/// Whether all readings lie within 2 % of the period of each other, so that nothing is to be seen.
bool one_phase(const std::vector<double>& phase, double period);

/// Ordered residuals over the quantiles of the normal distribution at (i - 1/2)/n; of many all the
/// outer ones and some of the inner ones. `row`: the readings.
struct Normal {
  Trace values;
  std::vector<std::size_t> row;
};
Normal normal_plot(const ModelFit&);

}  // namespace nonio::pdf_report
