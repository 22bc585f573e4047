// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/sdk/observations.h"

namespace nonio::math {

/// Stops closer than this are one stop, m; a slope of 10 um/m changes by 1 nm over this distance.
inline constexpr double same_stop = 1e-4;

/// Readings grouped by stop and direction of the axis in one column of the observations.
struct MeasuredLine {
  struct Stop {
    /// position of the axis, and of the second axis of the observations if they have two
    double position = 0.0, across = 0.0;
    double plus = 0.0, minus = 0.0;
    std::size_t n_plus = 0, n_minus = 0;
    std::vector<double> at_plus, at_minus;  ///< time of each reading, 0 to 1 over the file
    std::uint32_t source_line = 0;          ///< line of one reading in the file; 0: not known
    /// Mean of the readings from one direction; 0: mean of both means.
    double mean(int direction = 0) const {
      return direction > 0 ? plus : direction < 0 ? minus : (plus + minus) / 2.0;
    }
    double reversal() const { return plus - minus; }
  };
  std::vector<Stop> stops;  ///< sorted by position, ascending
  double walk_seen = 0.0;   ///< contribution to s^2 of a random walk with variance 1 over the file
  double s = 0.0;           ///< pooled standard deviation of a reading; 0: no repetition
  std::size_t dof = 0;
  bool zeroed = false;  ///< whether every reading at the first stop is 0

  /// Whether every stop was read from this direction; 0: from both directions.
  bool has(int direction) const;
  /// Returns 0 if every stop was read from both directions, otherwise the common direction;
  /// std::nullopt without one.
  std::optional<int> direction() const;
  /// Standard uncertainty of the mean at the stop with the fewest readings; 0 if it is not known.
  double u_mean(int direction = 0) const;
  double mean_reversal() const;
  /// Visits that contribute to the means, sorted by time; `direction` 0: means of both directions.
  /// The first stop of a `zeroed` line has no visits.
  std::vector<BudgetLine::Visit> visits(int direction) const;
  /// Returns the number of stops if no stop is at this position.
  std::size_t find(double position) const;
};

MeasuredLine measured_line(const Observations& observations, std::size_t column);

}  // namespace nonio::math
