// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// Statistics of one quantity of one machine over its campaigns. No files, no clock, no words:
/// values in, values out. Times are years from any day; values and uncertainties have one unit, all
/// uncertainties are standard (k = 1).
namespace nonio::statistics {

/// Signed standard uncertainty that all points with the same source have in common: an instrument
/// under one certificate, the expansion coefficient of an axis.
struct Common {
  std::string source;
  double u = 0.0;
};

struct Point {
  double time = 0.0;
  double value = 0.0;
  double u = 0.0;  ///< of what is new in each campaign
  std::vector<Common> common{};
};

/// Something that is known to have happened between point `after` and the next one.
struct Declared {
  enum class Kind { event, instrument, table };
  std::size_t after = 0;
  Kind kind = Kind::event;
};

/// Points of one comparable kind, in the order of their times; several of one time as they were
/// taken (as found before as left).
struct Series {
  std::vector<Point> points;
  std::vector<Declared> declared{};
  std::uint64_t seed = 1;  ///< of simulated nulls; the same for the same campaigns
  /// Factor of all `u`: campaigns of a laboratory may scatter more than their own `u` states
  /// (excess_of_ratios).
  double excess = 1.0;
  /// Standard deviation, per year, of the slopes that such series have in this laboratory
  /// (spread_of_slopes): what is known of a slope before the points, while steps are searched. 0:
  /// nothing is known, and a drift is tested.
  double spread = 0.0;
  /// A slope is estimated for a level too, and its uncertainty is in every forecast: a drift that
  /// was not detected may still exist.
  bool own_slope = false;
  /// A drift comes in where chance makes one in fewer series than this share.
  double drift_below = 0.01;
  /// Points that are followed by steps without a declared event, where they are known: no others
  /// are searched.
  std::optional<std::vector<std::size_t>> steps{};
};

/// An error that names the first point at fault: a value that is not finite, u that is not above 0,
/// a time before the one before it, an event after the last point.
Expected<void> check(const Series&);

/// d^2/u(d)^2 at a point of a series, d the point less the line through its neighbours: levels,
/// slopes and what they have in common cancel. Not over a declared event.
struct Scatter {
  std::size_t point = 0;
  double ratio = 0.0;
};
std::vector<Scatter> scatter_of(const Series&);
/// By how much points scatter more than their u, over many series: the root of the median of the
/// ratios over 0.4549, the median of chi-square with 1 degree of freedom; a step in few of them
/// moves a median little. Not below 1, and 1 for fewer than 20 points.
double excess_of_ratios(std::vector<double> ratios);

/// Slope per year, fitted together with a step at each declared event and at each place where
/// chance gives one in fewer than one of 10,000 series. None for fewer than four points, or if it
/// is not identifiable.
struct Slope {
  double b = 0.0, u = 0.0;
};
std::optional<Slope> slope_with_steps(const Series&);

/// Standard deviation sigma of the true slopes of many series, per year: the mean of
/// min(b^2/(sigma^2 + u^2), 9) is what it is of a normal variable, 0.995; so a few series that are
/// unlike the others move it little. 0 if chance alone makes such slopes in one laboratory of ten,
/// and for fewer than three. Source: method of moments for random effects (R. C. Paule, J. Mandel
/// 1982, general knowledge), trimmed.
double spread_of_slopes(const std::vector<Slope>&);

}  // namespace nonio::statistics
