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

/// Cache of trends and slopes, by the digest of all their inputs, so that a run computes only those
/// of its new campaigns. The cache changes no result: a damaged entry is computed again.
class Fits {
 public:
  Fits() = default;
  /// Returns a cache with the entries of an earlier `kept()`; empty if the bytes are damaged.
  static Fits of(std::string_view kept);

  nonio::statistics::Trend trend(const nonio::statistics::Series& series);
  std::optional<nonio::statistics::Slope> slope(const nonio::statistics::Series& series);

  /// Returns all entries that were requested, in the order of their keys.
  std::string kept() const;
  /// Returns whether the entries of `kept` differ from those at the start: an entry was computed,
  /// or an entry was not requested.
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
