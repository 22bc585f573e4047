// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// Statistics of one quantity of one machine over its campaigns, without access to files, clock or
/// texts. Times are in years from an arbitrary date, values and uncertainties in one unit;
/// uncertainties are standard uncertainties.
namespace nonio::statistics {

/// Signed standard uncertainty that points with the same source have in common, for example of an
/// instrument under one certificate.
struct Common {
  std::string source;
  double u = 0.0;
};

struct Point {
  double time = 0.0;
  double value = 0.0;
  double u = 0.0;  ///< without the common parts
  std::vector<Common> common{};
};

/// A known event between point `after` and the next point.
struct Declared {
  enum class Kind { event, instrument, table };
  std::size_t after = 0;
  Kind kind = Kind::event;
};

/// Comparable points, sorted by time; points of equal time in the order of measurement (as found
/// before as left).
struct Series {
  std::vector<Point> points;
  std::vector<Declared> declared{};
  std::uint64_t seed = 1;  ///< seed of the simulations, which depends on the campaigns only
  /// Factor on all `u`, because campaigns may scatter more than their `u` (excess_of_ratios).
  double excess = 1.0;
  /// Standard deviation of the slopes of such series, per year (spread_of_slopes): prior of the
  /// slope about 0 while steps are searched. 0 means no prior.
  double spread = 0.0;
  /// Whether a slope is always estimated, so that forecasts include the uncertainty of a drift that
  /// was not detected.
  bool own_slope = false;
  /// Significance level of a drift.
  double drift_below = 0.01;
  /// Points before the steps without a declared event, if known; no further steps are searched
  /// then.
  std::optional<std::vector<std::size_t>> steps{};
};

/// Returns an error for an empty or invalid series, with the number of the first invalid point: a
/// value that is not finite, u not positive, a time before the previous one, an event or step after
/// the last point. `spread` must be at least 0, `excess` at least 1.
Expected<void> check(const Series&);

/// Scatter d^2/u(d)^2, where d is the distance of a point from the line through its neighbors.
/// Levels, slopes and common parts cancel. The first and the last point, points between neighbors
/// of equal time, and points next to an event other than a change of the instrument are excluded.
struct Scatter {
  std::size_t point = 0;
  double ratio = 0.0;
};
std::vector<Scatter> scatter_of(const Series&);
/// Returns the factor by which points scatter more than their u: the root of the median of the
/// ratios over 0.4549, the median of chi-square with 1 degree of freedom. At least 1; 1 for fewer
/// than 20 ratios. Steps in few series hardly affect the median.
double excess_of_ratios(std::vector<double> ratios);
/// Returns the probability that noise of the stated u has at least this many ratios above 0.4549.
/// The variance of their number is taken as 1.5 times binomial, because ratios of neighbors are
/// correlated (1.43 for long series of equal u and interval).
double p_of_ratios(const std::vector<double>& ratios);

/// Slope per year, fitted with a step at each declared event and at each point where a step is
/// significant at 1 in 10,000. std::nullopt for fewer than four points or if the slope is not
/// identifiable.
struct Slope {
  double b = 0.0, u = 0.0;
};
std::optional<Slope> slope_with_steps(const Series&);

/// Returns the standard deviation sigma of the true slopes, per year: sigma solves mean of
/// min(b^2/(sigma^2 + u^2), 9) = 0.995, the expectation for a normal variable, so that a few
/// unusual series hardly affect it. 0 for fewer than three slopes, or if chance can explain the
/// slopes (at sigma = 0 the mean exceeds 0.995 by less than 1.88 of its standard deviations).
/// Source: method of moments for random effects (R. C. Paule, J. Mandel 1982, general knowledge),
/// trimmed.
double spread_of_slopes(const std::vector<Slope>&);

}  // namespace nonio::statistics
