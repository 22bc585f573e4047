// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/column_map.h"

namespace nonio::wide_table {

/// What the user says of one column.
struct Column {
  enum class Role : std::uint8_t { ignore, target, reading, mean, two_sigma, both, dead_zone };
  Role role = Role::ignore;
  Way way = Way::none;
  std::uint32_t run = 0;  ///< of a reading
};

/// Everything that a table does not say of itself and that nobody guesses.
struct Map : TableMap {
  std::vector<Column> columns;

  bool means() const;
  /// Of one of the tables: columns that say a run only have the way of the table.
  Map of(const RowRange& table) const;
};

Expected<Map> map_of(const Settings& options, bool rotary);

}  // namespace nonio::wide_table
