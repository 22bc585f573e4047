// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "laboratory/statistics/series.h"

/// Fits the trend of a series: a level, a drift, steps or a random walk. With V the covariance of
/// the points,
///
///   V_ij = delta_ij (excess u_i)^2 + sum over sources of u_c,i u_c,j,
///   b = (X' V^-1 X)^-1 X' V^-1 y,  C = (X' V^-1 X)^-1,  chi2 = r' V^-1 r,
///
/// computed by whitening with the Cholesky factor of V and a QR decomposition. Columns of X: 1; a
/// step at each declared event except changes of the instrument; undeclared steps; time.
///
/// Undeclared step: G_k is the decrease of chi2 by a step after point k. The p of the largest G is
/// Bonferroni's bound if it is below 0.001, where the bound is sharp, otherwise the result of up to
/// 10,000 simulated series of the same V and X. Drift: the decrease of chi2 by the column of time,
/// normal. A step is added if significant at 1 %, a drift at Series::drift_below; if both are, the
/// drift, unless its chi2 is more than 4 larger. A drift with a step against it is replaced by
/// steps alone if their chi2 is at most 4 larger. At most three steps are added. For eight points or
/// more, a random walk replaces a level that does not fit, or two or three steps if its likelihood
/// is larger than theirs with a penalty of 3 ln n per step.
///
/// With Series::spread, a row slope/spread = 0 is the prior of the slope while steps are searched
/// and their sizes are estimated. Slopes, segments and forecasts come from a fit without the prior,
/// because an interval that depends on the slopes of other machines covers too few slopes of
/// machines that wear.
///
/// Sources: JCGM 100:2008; generalized likelihood ratio (general knowledge; the null distribution
/// of the largest G is simulated, reference values in tests/unit/history).
namespace nonio::statistics {

enum class Model { none, level, drift, step, walk };

struct Segment {
  std::size_t from = 0, to = 0;        ///< indices of the first and the last point
  double first = 0.0, last = 0.0;      ///< values of the model at these points
  double u_first = 0.0, u_last = 0.0;  ///< including the common parts
  double slope = 0.0, u_slope = 0.0;   ///< per year
};

struct Change {
  enum class Cause { undeclared, event, instrument, table };
  std::size_t after = 0;  ///< index of the last point before the change
  double size = 0.0, u = 0.0;
  double p = 1.0;
  Cause cause = Cause::undeclared;
  std::optional<std::size_t> declared{};  ///< index into Series::declared
};

struct Trend {
  Model model = Model::none;
  std::vector<Segment> segments;
  std::vector<Change> changes;
  double chi2 = 0.0, dof = 0.0;  ///< of the fit with the prior of the slope
  /// Size that a step needs to be detected with a probability of 80 %, at the last place between
  /// two points where the fit has no step.
  std::optional<double> smallest_change{};
  bool line_or_step = false;  ///< whether the points cannot distinguish a drift from a step

  // The value after the last point is the sum of the coefficients; if `drifts`, the last
  // coefficient is multiplied by the time since the first point.
  std::vector<double> coefficients, covariance;  ///< covariance row by row
  bool drifts = false;
  double walk = 0.0;  ///< variance of a random walk per year
};

inline constexpr double named_below = 0.01;

/// Returns the errors of `check`. The model is `none` for fewer than three points; one point gives
/// no segments.
Expected<Trend> trend_of(const Series&);

}  // namespace nonio::statistics
