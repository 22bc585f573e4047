// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "nonio/sdk/plugin.h"

namespace nonio::siemens {

struct CrossChoices {
  std::int64_t first_table = 0;
  std::size_t max_points = 200;
  bool quoted_axes = false;
  std::map<std::string, std::size_t> numbers{};  ///< n of AXn by axis
};

/// Two CEC tables for each set of diagonals that gave both straightnesses: axis Y by the position
/// of X, and X by that of Y with the squareness in it.
Expected<void> write_cross_tables(const OutputInput&, const CrossChoices&, OutputResult&);

}  // namespace nonio::siemens
