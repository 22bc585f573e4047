// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// Statistics of one quantity of one machine over its campaigns. No files, no clock, no words:
/// values in, values out. Times are years from any day; values and uncertainties have one unit, all
/// uncertainties are standard (k = 1).
namespace nonio::history {

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
  /// Factor of all `u`: campaigns of a laboratory may scatter more than each says of itself
  /// (excess_scatter).
  double excess = 1.0;
};

/// An error that names the first point at fault: a value that is not finite, u that is not above 0,
/// a time before the one before it, an event behind the last point.
Expected<void> check(const Series&);

/// By how much points scatter more than their u, over many series: the root of the median of
/// d^2/u(d)^2 of successive differences d over 0.4549, the median of chi-square with 1 degree of
/// freedom; not below 1, and 1 for fewer than 20 differences. A step in few of them moves a median
/// little. Differences over a declared event do not count.
double excess_scatter(const std::vector<const Series*>&);

}  // namespace nonio::history
