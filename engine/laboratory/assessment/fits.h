// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "laboratory/statistics/series.h"
#include "laboratory/statistics/trend.h"
#include "platform/storage/serialise.h"

namespace nonio::storage {
NONIO_MEMBERS(statistics::Slope, a, b)
}  // namespace nonio::storage

namespace nonio::assessment {

/// Trends and slopes of series, kept by the digest of all their inputs: a run computes those of its
/// new campaigns. They change no result: a damaged entry is computed again.
class Fits {
 public:
  /// No fits are known.
  Fits() = default;
  /// With what `kept` returned.
  static Fits of(std::string_view kept);

  nonio::statistics::Trend trend(const nonio::statistics::Series& series);
  std::optional<nonio::statistics::Slope> slope(const nonio::statistics::Series& series);

  /// All that was requested, in the order of the keys.
  std::string kept() const;
  /// Whether a fit was added to those that were known before.
  bool is_new() const;
  std::size_t computed() const { return computed_; }

 private:
  struct Kept {
    std::string bytes;
    bool used = false;
  };
  Kept* find(const std::string& key);
  std::map<std::string, Kept> kept_;
  std::size_t computed_ = 0;
};

}  // namespace nonio::assessment
