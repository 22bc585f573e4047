// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"

namespace nonio::csv {

/// Run, direction and target, which identify a reading.
struct Key {
  std::uint32_t run = 0;
  std::int8_t approach = 0;
  double target = 0.0;

  auto tie() const { return std::tuple(run, approach, target); }
  bool operator<(const Key& other) const { return tie() < other.tie(); }
  bool operator==(const Key& other) const { return tie() == other.tie(); }
};

/// Detects that no key occurs twice without sorting: within each pass (run, direction) the targets
/// are strictly monotonic.
class PassOrder {
 public:
  void see(const Key& key);
  bool unique() const { return unique_; }

 private:
  struct Pass {
    double last = 0.0;
    int sense = 0;  ///< +1 ascending, -1 descending, 0 after a single target
  };
  bool unique_ = true;
  std::uint64_t current_ = 0;  ///< number of the pass; 0 before the first one
  Pass* pass_ = nullptr;
  std::unordered_map<std::uint64_t, Pass> passes_;
};

/// Removes repeated rows and adds a note. Error: rows with one key contradict each other. A reading
/// that exists in one of several rows is used. `not_taken` may be reordered; obs.missing is set to
/// the number of its keys without a reading.
Expected<void> settle_duplicates(Observations& obs, std::vector<Key>& not_taken);

}  // namespace nonio::csv
