// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::camonitor {

/// One line: PV, date, time, value; a status and a severity may follow.
struct Entry {
  std::string_view pv, value;
  std::int64_t time = 0;  ///< us since 1970-01-01, of the clock that the log is in
  std::uint64_t line = 0;
};

/// Nothing if the line is none of a camonitor log.
std::optional<Entry> entry_of(std::string_view line);

/// All entries of these PVs, by time; lines of one instant stay as they were. A log's first lines
/// (values at its start) are not in order.
Expected<std::vector<Entry>> entries_of(std::string_view bytes,
                                        const std::vector<std::string_view>& pvs);

}  // namespace nonio::camonitor
