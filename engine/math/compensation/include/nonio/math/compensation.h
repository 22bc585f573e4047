// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/sdk/error.h"

namespace nonio::math {

/// The deviation that a table should compensate, over position; m or rad. At target i, from the
/// means xm_i+ and xm_i- (ISO 230-2): plus xm_i+, minus xm_i-, mean (xm_i+ + xm_i-)/2.
struct ErrorCurve {
  std::vector<double> position;  ///< positions, strictly ascending
  std::vector<double> mean;
  std::vector<double> plus, minus;  ///< empty if not measured at every position
  /// number of targets omitted because they were approached from one of two directions only
  std::size_t left_out = 0;

  bool bidirectional() const { return !plus.empty() && !minus.empty(); }
  /// Mean of plus - minus, m or rad; 0 if only one direction was measured.
  double mean_reversal() const;

  /// Interpolates linearly, and returns the end value outside of the points. NaN without points.
  static double at(const std::vector<double>& position, const std::vector<double>& value, double x);
};

/// Returns the curve over the targets approached from both directions, or over all if only one
/// occurs: a target with one side would add a step of half the reversal to the mean.
ErrorCurve error_curve(const AxisTest& test);

/// Folds the curve of a rotary axis into 0..2 pi with equal ends. std::nullopt unless it covers the
/// turn: at least three positions, not longer than a turn, and an end gap of at most 1.5 times the
/// largest other gap. Positions that coincide are averaged.
std::optional<ErrorCurve> closed_turn(const ErrorCurve& curve);

struct Grid {
  double first = 0.0, step = 0.0;  ///< first position and interval of the points, m or rad
  std::size_t points = 0;
  double position(std::size_t i) const { return first + step * static_cast<double>(i); }
  double last() const { return points == 0 ? first : position(points - 1); }
};

struct GridRule {
  double unit = 1e-7;           ///< m or rad; first and step must be integer multiples of this unit
  std::size_t most = 200;       ///< largest number of points that the control accepts
  double step = 0.0;            ///< step requested by the user; 0: `choose_grid` chooses it
  std::optional<double> first;  ///< first point requested by the user; absent: start of the curve
  std::optional<double> anchor;  ///< position that must be a point of the grid
  bool turn = false;             ///< whether the curve is a closed turn, which the step must divide
  bool power_of_two = false;     ///< whether the step must be `unit` times a power of two
  bool rotary = false;
  std::string axis;
};

/// Returns the grid of the requested step; without one, that of evenly spaced targets, otherwise
/// the coarsest that contains every position of the curve with a step of at least 1/8 of their mean
/// distance. Otherwise the curve is interpolated, with a step of about half the smallest or a
/// quarter of the mean distance, whichever is larger, or more if the control accepts too few points
/// for it. Errors, with the axis: fewer than 2 targets or points; a first point after the last
/// target; a requested step that is not an integer multiple of `unit`, does not divide the turn or
/// is not a power of two; more points than the control accepts, with a suggestion.
Expected<Grid> choose_grid(const std::vector<double>& position, const GridRule& rule);

/// Rounds each value to an integer number of `unit` (half away from zero, to 12 digits: 2.5 um is a
/// tie). unit > 0; quotients within the range of std::int64_t.
std::vector<std::int64_t> quantised(std::span<const double> value, double unit);
/// The same in SI.
std::vector<double> rounded(std::vector<double> value, double unit);
/// Returns q[i] - q[i-1], one value fewer than `absolute`. Rounding the absolute curve first keeps
/// the sum of the increments within half a unit of the curve at every point.
std::vector<std::int64_t> increments(std::span<const std::int64_t> absolute);

/// What a control adds to position `x` approached in `direction` (+1, -1); m or rad.
using Correction = std::function<double(double x, int direction)>;

/// U of the reversal that a correction removes: `of_target` if it differs between targets, `of_mean`
/// if it is the same for all, 0 if there is none.
double reversal_uncertainty(const ErrorCurve&, const Correction&, double of_target, double of_mean);

struct MeanDeviations {
  std::vector<double> plus, minus;  ///< deviations by direction, m or rad; empty if not measured
  double E() const;                 ///< range of both directions, or of the single direction
  double M() const;                 ///< range of the mean of both; NaN for one direction
  double B() const;                 ///< max |plus - minus|; NaN for one direction
};

MeanDeviations before(const ErrorCurve& curve);
/// Returns actual - x = c(x) + e(x + c(x)), with the curve e and the correction c, because the
/// error is that at the position of the motor.
MeanDeviations after(const ErrorCurve& curve, const Correction& correction);

}  // namespace nonio::math
