// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"

namespace nonio::csv {

/// Run, direction and target of a reading: it can be taken only once.
struct Key {
  std::uint32_t run = 0;
  std::int8_t approach = 0;
  double target = 0.0;

  auto tie() const { return std::tuple(run, approach, target); }
  bool operator<(const Key& other) const { return tie() < other.tie(); }
  bool operator==(const Key& other) const { return tie() == other.tie(); }
};

/// Watches the rows go by. As long as the targets of every pass (run, direction) only rise or only
/// fall, whatever is between them, no key can have occurred twice, and nothing needs sorting.
class PassOrder {
 public:
  void see(const Key& key);
  bool unique() const { return unique_; }

 private:
  struct Pass {
    double last = 0.0;
    int sense = 0;  ///< of its targets; 0: only one so far
  };
  bool unique_ = true;
  std::uint64_t current_ = 0;  ///< number of the pass; 0: none yet
  Pass* pass_ = nullptr;
  std::unordered_map<std::uint64_t, Pass> passes_;
};

/// Drops repeated rows, with a note; an error where rows of one key contradict each other. A key
/// that was not taken in one row and taken in another is taken. `not_taken` may be reordered; on
/// return obs.missing counts its distinct keys that were never taken.
Expected<void> settle_duplicates(Observations& obs, std::vector<Key>& not_taken);

}  // namespace nonio::csv
