// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nonio/sdk/observations.h"

namespace nonio::math {

/// The readings of one axis, arranged by target and direction of approach. Targets are matched by
/// value, never by index: one that was approached from one side only has readings on that side
/// only.
///
/// x_ij = P_ij - P_i: deviation of approach j = 1..n at target i = 1..m, m or rad; + and -:
/// direction of approach. Source: ISO 230-2 (docs/formulas.md). Range: any number of targets and
/// readings, n may differ; deviations finite (sdk/check.h).
class AxisTest {
 public:
  struct Reading {
    double deviation;  ///< deviation x_ij, m or rad
    std::uint32_t run;
    std::uint32_t row;  ///< row in the observations
    bool operator==(const Reading&) const = default;
  };

  bool rotary = false;
  std::vector<double> targets;  ///< target positions, m or rad, strictly ascending

  std::span<const Reading> plus(std::size_t i) const { return part(2 * i); }
  std::span<const Reading> minus(std::size_t i) const { return part(2 * i + 1); }
  std::span<const Reading> readings() const { return readings_; }

  bool has_plus() const { return has_plus_; }
  bool has_minus() const { return has_minus_; }
  bool bidirectional() const { return has_plus_ && has_minus_; }
  /// Returns whether every target has readings from every direction that occurs; false without
  /// targets.
  bool complete() const;
  /// Return the smallest and the largest number of readings at one target from one direction, over
  /// all directions that occur. The smallest is 0 if a target was not approached from one of them.
  std::size_t least_approaches() const;
  std::size_t most_approaches() const;
  /// Returns the distance from the first target to the last, m or rad.
  double length() const { return targets.empty() ? 0.0 : targets.back() - targets.front(); }

  /// Returns the test with these targets only (ascending indices, each below targets.size()).
  AxisTest only(std::span<const std::size_t> kept) const;

  /// Arranges observations by their first axis column; rows without a direction of approach or with
  /// a position that is not finite are omitted. Readings at a target are in the order of their
  /// runs. The test is empty, which is not an error, if there is no axis column or it has no
  /// directions of approach.
  static AxisTest arrange(const Observations&);

  bool operator==(const AxisTest&) const = default;

 private:
  std::span<const Reading> part(std::size_t k) const {
    return std::span(readings_).subspan(starts_[k], starts_[k + 1] - starts_[k]);
  }
  std::vector<Reading> readings_;    // sorted by target, direction (+ first), run
  std::vector<std::size_t> starts_;  // 2 * targets + 1 entries
  bool has_plus_ = false, has_minus_ = false;
};

/// Returns the deviations of the readings, m or rad, in their order.
std::vector<double> deviations(std::span<const AxisTest::Reading>);

}  // namespace nonio::math
