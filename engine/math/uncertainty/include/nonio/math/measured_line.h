// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/sdk/observations.h"

namespace nonio::math {

/// Stops nearer than this are one stop: far above a control's resolution, and a slope of 10 um/m
/// makes 1 nm of it.
inline constexpr double same_stop = 1e-4;

/// Readings by stop and direction of the axis in one column of the observations.
struct MeasuredLine {
  struct Stop {
    double position = 0.0, across = 0.0;  ///< of the axis, and of the second axis if there is one
    double plus = 0.0, minus = 0.0;       ///< means
    std::size_t n_plus = 0, n_minus = 0;
    std::vector<double> at_plus, at_minus;  ///< time of each reading, 0 to 1 over the file
    std::uint32_t source_line = 0;          ///< of the file, of one reading; 0: not known
    /// Of the readings from one direction, or (0) of both.
    double mean(int direction = 0) const {
      return direction > 0 ? plus : direction < 0 ? minus : (plus + minus) / 2.0;
    }
    double reversal() const { return plus - minus; }
  };
  std::vector<Stop> stops;  ///< ascending
  double walk_seen = 0.0;   ///< of s^2, by a walk of variance 1 over the file
  double s = 0.0;           ///< pooled standard deviation of a reading; 0: no repetition
  std::size_t dof = 0;      ///< of s
  bool zeroed = false;      ///< every reading at the first stop is 0

  /// Whether every stop was read from this direction, or (0) from both.
  bool has(int direction) const;
  /// 0 if every stop was read from both directions, else the one from which every stop was read.
  std::optional<int> direction() const;
  /// Standard uncertainty of the mean of this direction, or (0) of both; 0 if unknown.
  double u_mean(int direction = 0) const;
  double mean_reversal() const;
  /// What the means of this direction, or (0) of both, were made of, by time.
  std::vector<BudgetLine::Visit> visits(int direction) const;
  /// Index of the stop at this position, or the number of stops.
  std::size_t find(double position) const;
};

MeasuredLine measured_line(const Observations& observations, std::size_t column);

}  // namespace nonio::math
