// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "nonio/history/series.h"
#include "nonio/history/trend.h"

namespace nonio::host::morning {

/// Trends and slopes of series, kept by the digest of all that goes into them: a night computes
/// those of its new campaigns. What is kept changes no result; a file that is not there, is damaged
/// or of another version is none.
class Fits {
 public:
  /// Keeps nothing beyond its life.
  Fits() = default;
  /// With what OUT/.nonio/trends has.
  static Fits kept_in(const std::filesystem::path& out);

  nonio::history::Trend trend(const nonio::history::Series& series);
  std::optional<nonio::history::Slope> slope(const nonio::history::Series& series);

  /// Keys of what was asked for since the last call.
  std::vector<std::string> take_asked() { return std::exchange(asked_, {}); }
  /// Stays although nobody asks for it tonight.
  void retain(const std::vector<std::string>& keys);

  /// What was asked for since, or retained, into OUT/.nonio/trends; nothing if it is all there. Not being able
  /// to is no error.
  void keep_in(const std::filesystem::path& out) const;
  std::size_t computed() const { return computed_; }

 private:
  struct Kept {
    std::string bytes;
    bool used = false;
  };
  Kept* find(const std::string& key);
  std::unordered_map<std::string, Kept> kept_;
  std::vector<std::string> asked_;
  std::size_t computed_ = 0;
};

}  // namespace nonio::host::morning
