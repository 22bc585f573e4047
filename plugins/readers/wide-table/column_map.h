// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/settings.h"

namespace nonio::wide_table {

/// What the user says of one column.
struct Column {
  enum class Role : std::uint8_t { ignore, target, reading, mean, two_sigma, both, dead_zone };
  /// `forward` is as the targets are listed, `plus` towards larger coordinates.
  enum class Way : std::uint8_t { none, plus, minus, forward, reverse };
  Role role = Role::ignore;
  Way way = Way::none;
  std::uint32_t run = 0;  ///< of a reading
};

/// Everything that a table does not say of itself and that nobody guesses.
struct Map {
  std::vector<Column> columns;
  char separator = ' ';      ///< blank: any number of blanks and tabs
  double target_unit = 0.0;  ///< SI value of 1
  double value_unit = 0.0;
  bool positions = false;                       ///< values are positions, else deviations
  double sign = 1.0;                            ///< of deviations
  std::uint64_t first_line = 1, last_line = 0;  ///< of the rows; last 0: the end of the file

  bool means() const;
};

Expected<Map> map_of(const Settings& options, bool rotary);

}  // namespace nonio::wide_table
