// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// Statistics of one quantity of one machine over its campaigns, without access to files, clock or
/// texts. Times are in years from an arbitrary day; values and uncertainties have one unit; all
/// uncertainties are standard (k = 1).
namespace nonio::statistics {

/// Signed standard uncertainty that all points with the same source have in common, for example an
/// instrument under one certificate, or the expansion coefficient of an axis.
struct Common {
  std::string source;
  double u = 0.0;
};

struct Point {
  double time = 0.0;
  double value = 0.0;
  double u = 0.0;  ///< standard uncertainty without the common parts
  std::vector<Common> common{};
};

/// A known event between point `after` and the next one.
struct Declared {
  enum class Kind { event, instrument, table };
  std::size_t after = 0;
  Kind kind = Kind::event;
};

/// Comparable points, sorted by time; points of equal time in the order in which they were taken
/// (as found before as left).
struct Series {
  std::vector<Point> points;
  std::vector<Declared> declared{};
  std::uint64_t seed = 1;  ///< seed of the simulations; the same campaigns give the same seed
  /// Factor on all `u`, because the campaigns of a laboratory may scatter more than their `u`
  /// states (excess_of_ratios).
  double excess = 1.0;
  /// Standard deviation, per year, of the slopes of such series in this laboratory
  /// (spread_of_slopes), which is the prior of the slope about 0 while steps are searched; 0: no
  /// prior.
  double spread = 0.0;
  /// Whether a slope is estimated even for a level, so that its uncertainty is part of every
  /// forecast: a drift that was not detected may still exist.
  bool own_slope = false;
  /// Significance level of a drift.
  double drift_below = 0.01;
  /// Points that are followed by a step without a declared event, if they are known; no further
  /// steps are searched then.
  std::optional<std::vector<std::size_t>> steps{};
};

/// Returns an error for a series that is empty or invalid. It names the first invalid point: a
/// value, time or common part that is not finite, u that is not above 0, a time before the previous
/// one, an event or a step after the last point. `spread` has to be at least 0, `excess` at least
/// 1.
Expected<void> check(const Series&);

/// Scatter at one point: d^2/u(d)^2, where d is the point minus the line through its neighbors.
/// Levels, slopes and common parts cancel. Left out are the first and the last point, points whose
/// neighbors have the same time, and points next to a declared event other than a change of the
/// instrument.
struct Scatter {
  std::size_t point = 0;
  double ratio = 0.0;
};
std::vector<Scatter> scatter_of(const Series&);
/// Returns the factor by which points scatter more than their u, over many series: the root of the
/// median of the ratios over 0.4549, the median of chi-square with 1 degree of freedom. Steps in
/// few series hardly affect the median. Not below 1, and 1 for fewer than 20 ratios.
double excess_of_ratios(std::vector<double> ratios);

/// Slope per year, fitted together with a step at each declared event and at each place where a
/// step is significant at 1 in 10,000 series. None for fewer than four points, or if it is not
/// identifiable.
struct Slope {
  double b = 0.0, u = 0.0;
};
std::optional<Slope> slope_with_steps(const Series&);

/// Returns the standard deviation sigma of the true slopes of many series, per year: sigma solves
/// mean of min(b^2/(sigma^2 + u^2), 9) = 0.995, its value for a normal variable, so that a few
/// unusual series hardly affect it. Returns 0 for fewer than three slopes, and if the mean for
/// sigma = 0 exceeds 0.995 by less than 1.88 of its standard deviations, because chance alone may
/// then explain the slopes. Source: method of moments for random effects (R. C. Paule, J. Mandel
/// 1982, general knowledge), trimmed.
double spread_of_slopes(const std::vector<Slope>&);

}  // namespace nonio::statistics
