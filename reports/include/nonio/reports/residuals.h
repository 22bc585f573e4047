// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "nonio/reports/wording.h"
#include "nonio/sdk/results.h"

/// The words and numbers of the picture of readings with their model and the nine pictures of
/// residuals. SI.
namespace nonio::reports {

/// The pictures in the order that never changes.
enum class ResidualPlot {
  position,
  reversal,
  time,
  run,
  phase,
  temperature,
  predicted,
  normal,
  left_out
};

/// What one of them states; `none`: why there is nothing to draw, empty if there is something.
struct PictureWords {
  std::string title, x, y, says, none;
  std::string time_unit{};  ///< of the third: s, min or h
  double x_per_si = 1.0;    ///< what x is multiplied by before it is printed
  bool degrees = false;     ///< x is an angle of the turn
};
/// The words are those of templates/words/<language>/pictures.toml.
std::array<PictureWords, 9> picture_words(const ModelFit&, const Wording&);

/// Of the picture that comes before them: readings and model, residuals below.
PictureWords fit_words(const ModelFit&, const Wording&);

/// One run in one direction on one measurement.
struct Pass {
  std::uint32_t measurement = 0;
  int direction = 0;
  std::vector<std::size_t> rows;  ///< in the order of their places
  bool is_path = true;            ///< no two readings have the same place
};
std::vector<Pass> passes_of(const ModelFit&);

/// The period of the fifth picture: screw pitch, tooth, or a whole turn; 0 if it is not known.
double period_of(const ModelFit&);

/// A curve, or points.
struct Trace {
  std::vector<double> x, y;
};

/// Readings that count: their weight shows that they are no suspected misreading.
bool counts(const ModelFit&, std::size_t row);

/// Mean residual of the readings of one direction at each target.
Trace mean_by_target(const ModelFit&, int direction);
/// The readings of one measurement: means over those of several lines would mix their places.
ModelFit of_measurement(const ModelFit&, std::uint32_t measurement);
/// Displacements over time: places are times.
bool over_time(const ModelFit&);
/// A place of a reading as it is printed: less `from`, times `per_si`.
struct PlaceScale {
  double from = 0.0, per_si = 1.0;
  std::string unit;
};
PlaceScale place_scale(const ModelFit&);
/// Several axes: places are those on each line.
bool in_space(const ModelFit&);

/// Lines in space next to each other: each has a lane of width 1 on the horizontal axis.
struct Lanes {
  std::vector<std::string> names;               ///< empty: there is one line, or all have one axis
  std::vector<std::pair<double, double>> ends;  ///< first and last place of each, SI
  /// Position of a place of this line: the lane's number and the part of its length, with room at
  /// both sides.
  double at(std::size_t line, double place) const;
};
Lanes lanes_of(const ModelFit&);

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

/// Ordered residuals over the quantiles of the normal distribution at (i - 1/2)/n; of many all the
/// outer ones and some of the inner ones. `row`: the readings.
struct Normal {
  Trace values;
  std::vector<std::size_t> row;
};
Normal normal_plot(const ModelFit&);

}  // namespace nonio::reports
