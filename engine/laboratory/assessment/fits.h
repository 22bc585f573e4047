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

/// Cache of trends and slopes by the digest of their inputs, so that a run computes only those of
/// new campaigns. Damaged entries are computed again.
class Fits {
 public:
  Fits() = default;
  /// Returns a cache with the entries of `kept()` of an earlier run; empty if the bytes are
  /// damaged.
  static Fits of(std::string_view kept);

  nonio::statistics::Trend trend(const nonio::statistics::Series& series);
  std::optional<nonio::statistics::Slope> slope(const nonio::statistics::Series& series);

  /// Returns the entries that were used, sorted by key.
  std::string kept() const;
  /// Whether `kept` differs from the initial entries.
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
