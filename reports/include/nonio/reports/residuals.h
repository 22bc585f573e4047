// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "nonio/reports/wording.h"
#include "nonio/sdk/results.h"

/// Texts and numbers of the figure of readings and model, and of the nine figures of residuals. SI.
namespace nonio::reports {

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

/// `none` is the reason if there is nothing to draw, otherwise empty.
struct PictureWords {
  std::string title, x, y, says, none;
  std::string time_unit{};  ///< for the figure over time: s, min or h
  double x_per_si = 1.0;    ///< factor from SI to the printed x
  bool degrees = false;     ///< x is an angle within a revolution
};
/// Texts of templates/words/<language>/pictures.toml.
std::array<PictureWords, 9> picture_words(const ModelFit&, const Wording&);

/// Texts of the first figure: readings and model, with residuals below.
PictureWords fit_words(const ModelFit&, const Wording&);

/// One run in one direction of a measurement.
struct Pass {
  std::uint32_t measurement = 0;
  int direction = 0;
  std::vector<std::size_t> rows;  ///< rows of the readings, sorted by position
  bool is_path = true;            ///< whether all positions are different
};
std::vector<Pass> passes_of(const ModelFit&);

/// Period for the phase figure: screw pitch, tooth, or revolution; 0 if not known.
double period_of(const ModelFit&);

struct Trace {
  std::vector<double> x, y;
};

/// Whether the reading has weight, so that it is not a suspected misreading.
bool counts(const ModelFit&, std::size_t row);

Trace mean_by_target(const ModelFit&, int direction);
/// The part of the fit for one measurement, because positions of several lines must not be mixed.
ModelFit of_measurement(const ModelFit&, std::uint32_t measurement);
/// Whether these are displacements over time; positions are then times.
bool over_time(const ModelFit&);
/// Printed position: (position - from) * per_si.
struct PlaceScale {
  double from = 0.0, per_si = 1.0;
  std::string unit;
};
PlaceScale place_scale(const ModelFit&);
/// Whether the readings have several axes; positions are then those on each line.
bool in_space(const ModelFit&);

/// Lines in space side by side, each in a lane of width 1 on the horizontal axis.
struct Lanes {
  std::vector<std::string> names;               ///< empty with a single line or axis
  std::vector<std::pair<double, double>> ends;  ///< first and last position of each lane, SI
  /// Horizontal position: lane number plus relative position in the lane, with margins.
  double at(std::size_t line, double place) const;
};
Lanes lanes_of(const ModelFit&);

/// Mean residual in up to 12 equal intervals of x with at least three readings.
Trace mean_by_part(const ModelFit&, const std::vector<double>& x);

Trace mean_by_run(const ModelFit&);

/// Difference of the mean residuals in + and - direction at targets with both.
struct Reversal {
  Trace values;
  std::vector<double> spread;  ///< standard deviation of the difference for unit standard deviation
                               ///< of a reading
};
Reversal reversal_of(const ModelFit&);

/// Phase of each reading, 0 <= phase < period.
std::vector<double> phase_of(const ModelFit&, double period);

/// Sorted residuals over normal quantiles at (i - 1/2)/n; for many readings, all outer and some
/// inner points. `row` is the index of each reading.
struct Normal {
  Trace values;
  std::vector<std::size_t> row;
};
Normal normal_plot(const ModelFit&);

}  // namespace nonio::reports
