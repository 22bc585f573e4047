// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "laboratory/statistics/series.h"

/// Fits the trend of a series: a level, a drift, steps. With V the covariance of the points,
///
///   V_ij = delta_ij (excess u_i)^2 + sum over sources of u_c,i u_c,j,
///   b = (X' V^-1 X)^-1 X' V^-1 y,  C = (X' V^-1 X)^-1,  chi2 = r' V^-1 r,
///
/// computed by whitening with the Cholesky factor of V and a QR decomposition. Columns of X: 1; a
/// step at each declared event except changes of the instrument; undeclared steps; time.
///
/// An undeclared step: G_k is the decrease of chi2 by a step after point k. The largest G over the
/// places without a declared step is tested; its p is Bonferroni's bound if that is below 0.001
/// (where it is sharp), otherwise it comes from up to 10,000 simulated series of the same V and X.
/// A drift: the decrease of chi2 by a column of time, normal. A step is added if significant at 1
/// %, a drift at Series::drift_below; if both are, the drift is preferred unless its chi2 is more
/// than 4 larger. At most three steps are added. For eight points or more, a random walk replaces a
/// level that does not fit, or two or three steps if the walk is likelier than they are with a
/// penalty of 3 ln n each.
///
/// If the spread of slopes in the laboratory is known (Series::spread), a row slope/spread = 0
/// keeps the slope near 0 while steps are searched and their sizes are estimated. Slopes, segments
/// and forecasts come from a fit with a free slope (Series::own_slope: for a level too), because an
/// interval that depends on the slopes of other machines covers 95 % of all slopes together, but
/// too few of those of machines that wear.
///
/// Sources: JCGM 100:2008; generalized likelihood ratio (general knowledge; the null distribution
/// of the largest G is simulated here, reference values in tests/unit/history).
namespace nonio::statistics {

enum class Model { none, level, drift, step, walk };

struct Segment {
  std::size_t from = 0, to = 0;        ///< indices of the first and the last point, both included
  double first = 0.0, last = 0.0;      ///< values of the model at these points
  double u_first = 0.0, u_last = 0.0;  ///< standard uncertainties of these values, including the
                                       ///< common parts
  double slope = 0.0, u_slope = 0.0;   ///< slope and its standard uncertainty, per year
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
  std::vector<Change> changes;   ///< sorted by time
  double chi2 = 0.0, dof = 0.0;  ///< chi2 and degrees of freedom of the fit with the prior of the
                                 ///< slope
  /// Size of a step in the last gap without a step that would be detected with a probability of
  /// 80 %; none without such a gap.
  std::optional<double> smallest_change{};
  bool line_or_step = false;  ///< whether these points cannot distinguish a drift from a step

  // For extrapolation (forecast.h): the model at a time after the last point is the sum of all
  // coefficients, the last of them multiplied by the time since the first point if `drifts`.
  std::vector<double> coefficients, covariance;  ///< covariance row by row
  bool drifts = false;
  double walk = 0.0;  ///< variance per year of a random walk
};

inline constexpr double named_below = 0.01;

/// Fits the trend. Returns the errors of `check`. For fewer than three points the model is `none`,
/// and one point gives no segments either.
Expected<Trend> trend_of(const Series&);

}  // namespace nonio::statistics
