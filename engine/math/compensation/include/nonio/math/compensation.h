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

/// What all controllers' tables have in common: the curve to be compensated, the grid, integers
/// without drift, and what is left when the control has applied the table.
namespace nonio::math {

/// The deviation that a table should compensate; m or rad over m or rad. At target i, of means
/// xm_i+ and xm_i- (ISO 230-2): plus xm_i+, minus xm_i-, mean (xm_i+ + xm_i-)/2.
struct ErrorCurve {
  std::vector<double> position;     ///< strictly ascending
  std::vector<double> mean;         ///< of both directions
  std::vector<double> plus, minus;  ///< empty if that direction was not measured at every position
  std::size_t left_out = 0;         ///< targets that were reached from one of two directions only

  bool bidirectional() const { return !plus.empty() && !minus.empty(); }
  /// Mean of plus - minus over the positions; 0 if one direction only was measured.
  double mean_reversal() const;

  /// Linear between the points, the end value outside.
  static double at(const std::vector<double>& position, const std::vector<double>& value, double x);
};

/// Of the targets that were reached from both directions, or of all where one direction only
/// occurs: half of the reversal would jump into the mean at a target that has one side.
ErrorCurve error_curve(const AxisTest& test);

/// The curve of a rotary axis folded into 0..2 pi with equal ends, if it covers the turn: no gap
/// is larger than one and a half times the largest one between neighbours, and all of it is not
/// more than a turn. Positions that coincide after folding are averaged.
std::optional<ErrorCurve> closed_turn(const ErrorCurve& curve);

struct Grid {
  double first = 0.0, step = 0.0;  ///< m or rad
  std::size_t points = 0;
  double position(std::size_t i) const { return first + step * static_cast<double>(i); }
  double last() const { return points == 0 ? first : position(points - 1); }
};

/// The requirements of a control for equidistant points.
struct GridRule {
  double unit = 1e-7;            ///< m or rad; first and step are whole multiples of it
  std::size_t most = 200;        ///< points that the control takes
  double step = 0.0;             ///< the user's wish; 0: chosen here
  std::optional<double> first;   ///< the user's wish; else where the curve begins
  std::optional<double> anchor;  ///< must be a point of the grid (a reference position)
  bool turn = false;             ///< the curve is a closed turn and the step divides it
  bool power_of_two = false;     ///< step = unit times a power of two
  bool rotary = false;           ///< for the words of an error: deg, not mm
  std::string axis;              ///< for the words of an error
};

/// The coarsest grid that has every position of the curve on it, if it is not much finer than
/// they are; else a grid of about half their smallest distance, between which the curve is
/// interpolated. Errors name the axis: fewer than 2 targets or points; a wished step that is no
/// whole multiple of `unit`; more points than the control takes, with a suggestion.
Expected<Grid> choose_grid(const std::vector<double>& position, const GridRule& rule);

/// Whole numbers of `unit`, each nearest to its value (half away from zero, to 12 digits: 2.5 um
/// are a tie). unit > 0; quotients within the range of std::int64_t.
std::vector<std::int64_t> quantised(std::span<const double> value, double unit);
/// q[i] - q[i-1], one less than there are values: rounding the absolute curve first keeps the sum
/// of the increments within half a unit of the curve at every point.
std::vector<std::int64_t> increments(std::span<const std::int64_t> absolute);

/// What a control adds to the position at `x`, reached in `direction` (+1, -1); m or rad.
using Correction = std::function<double(double x, int direction)>;

/// Mean deviations at the positions of a curve, and their ISO 230-2 letters.
struct MeanDeviations {
  std::vector<double> plus, minus;  ///< empty if not measured
  double E() const;                 ///< range of both; of the one direction if there is one only
  double M() const;                 ///< range of the mean of both; NaN for one direction
  double B() const;                 ///< max |plus - minus|; NaN for one direction
};

MeanDeviations before(const ErrorCurve& curve);
/// actual - x = c(x) + e(x + c(x)): the error arises where the motor is. e: curve, c: correction.
/// Derived; checked by the controllers' tests (tests/unit/controllers).
MeanDeviations after(const ErrorCurve& curve, const Correction& correction);

}  // namespace nonio::math
