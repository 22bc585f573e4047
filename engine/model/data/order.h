// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/observations.h"

namespace nonio::model {

/// In which order the readings of one axis were taken.
struct Order {
  std::vector<std::uint32_t> rows;  ///< of the table, first reading first
  bool known = true;                ///< false: nobody knows; nothing is to be concluded from time
  bool assumed = false;             ///< the cycle of the standard, since the file's cannot be it
};

/// `said` as in the manifest: "pendulum", "as-listed", "unknown", or empty. Times that every
/// reading has count before all else. Without them and without a word: as listed, unless no machine
/// can have run so: all of one direction before all of the other in several runs, or a pass listed
/// against its own direction. Then the cycle of ISO 230-2 (there and back, run by run).
Order order_of(const Observations& o, const std::string& said);

}  // namespace nonio::model
