// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nonio/sdk/observations.h"

namespace nonio::math {

/// Readings of one axis by target and direction of approach (ISO 230-2). Targets are matched by
/// value, not by index. A target may have any number of readings, or none from one direction.
class AxisTest {
 public:
  struct Reading {
    double deviation;  ///< x_ij = P_ij - P_i of ISO 230-2, m or rad
    std::uint32_t run;
    std::uint32_t row;
    bool operator==(const Reading&) const = default;
  };

  bool rotary = false;
  std::vector<double> targets;  ///< m or rad, strictly ascending

  std::span<const Reading> plus(std::size_t i) const { return part(2 * i); }
  std::span<const Reading> minus(std::size_t i) const { return part(2 * i + 1); }
  std::span<const Reading> readings() const { return readings_; }

  bool has_plus() const { return has_plus_; }
  bool has_minus() const { return has_minus_; }
  bool bidirectional() const { return has_plus_ && has_minus_; }
  /// Whether every target has readings from each direction that occurs; false without targets.
  bool complete() const;
  /// Smallest and largest number of readings at one target from one direction. The smallest is 0 if
  /// a target lacks a direction that occurs at other targets.
  std::size_t least_approaches() const;
  std::size_t most_approaches() const;
  /// Distance from the first target to the last, m or rad.
  double length() const { return targets.empty() ? 0.0 : targets.back() - targets.front(); }

  /// `kept`: ascending indices, each below targets.size().
  AxisTest only(std::span<const std::size_t> kept) const;

  /// Uses the first axis column. Rows without a direction of approach or with a position that is
  /// not finite are omitted. Readings of a target are in the order of their runs. The test is
  /// empty, without an error, if the column or its directions of approach are missing.
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

/// Deviations in the order of the readings, m or rad.
std::vector<double> deviations(std::span<const AxisTest::Reading>);

}  // namespace nonio::math
