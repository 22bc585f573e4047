// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "laboratory/statistics/series.h"

/// What a series did: a level, a drift, steps. With V the covariance of the points,
///
///     V_ij = delta_ij (excess u_i)^2 + sum over sources of u_c,i u_c,j,
///     b = (X' V^-1 X)^-1 X' V^-1 y,  C = (X' V^-1 X)^-1,  chi2 = r' V^-1 r,
///
/// by whitening with the Cholesky factor of V and a QR decomposition. Columns of X: 1; a step at
/// each declared event (its size is estimated, not tested away); undeclared steps; time.
///
/// An undeclared step: G_k, the decrease of chi2 by a step after point k, largest over the places
/// without a declared one; its p is that of the largest, by Bonferroni's bound where that is below
/// 0.001 (where it is sharp), else from 10,000 simulated series of the same V and X. A drift: the
/// decrease of chi2 by a column of time, normal. Either is added if significant at 1 %; of both the
/// drift, if its chi2 is at most 4 larger. Up to three steps. Of eight points or more: a level that
/// wanders (random walk) in place of a level that does not hold, or of two steps or three if it is
/// likelier than they are at a price of 3 ln n each.
///
/// Where the laboratory's slopes are known to spread (Series::spread), a slope is held near 0 by a
/// row slope/spread = 0 while steps are searched, and for their sizes. Slopes, segments and
/// forecasts are of a fit with a free slope (Series::own_slope: of a level too): an interval that
/// leans on the slopes of other machines covers 95 % of all slopes together, but too few of those
/// that wear.
///
/// Sources: JCGM 100:2008; generalised likelihood ratio (general knowledge; the null of the largest
/// is simulated here, reference values in tests/unit/history).
namespace nonio::statistics {

enum class Model { none, level, drift, step, walk };

struct Segment {
  std::size_t from = 0, to = 0;        ///< points, both included
  double first = 0.0, last = 0.0;      ///< what the model predicts there
  double u_first = 0.0, u_last = 0.0;  ///< with the part that all points have in common
  double slope = 0.0, u_slope = 0.0;   ///< per year
};

struct Change {
  enum class Cause { undeclared, event, instrument, table };
  std::size_t after = 0;  ///< last point before it
  double size = 0.0, u = 0.0;
  double p = 1.0;
  Cause cause = Cause::undeclared;
  std::optional<std::size_t> declared{};  ///< index into Series::declared
};

struct Trend {
  Model model = Model::none;
  std::vector<Segment> segments;
  std::vector<Change> changes;   ///< by time
  double chi2 = 0.0, dof = 0.0;  ///< with the slope held
  /// A step at the last place that is named 8 times in 10.
  std::optional<double> smallest_change{};
  bool line_or_step = false;  ///< these points cannot separate a drift from a step

  // To go on from here (forecast.h): what the model predicts at a time after the last point is
  // coefficients . (1, 1 of each change, time).
  std::vector<double> coefficients, covariance;  ///< covariance row by row
  bool drifts = false;
  double walk = 0.0;  ///< variance of a random walk, per year
};

inline constexpr double named_below = 0.01;

/// An error as `check` gives it. Of one point there is no model; of two only their difference.
Expected<Trend> trend_of(const Series&);

}  // namespace nonio::statistics
