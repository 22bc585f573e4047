// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "nonio/sdk/plugin.h"
#include "table.h"

namespace nonio::csv {

using Kind = ColumnSpec::Kind;
using Sense = std::array<double, 3>;

inline constexpr double per_mm = 1e-3, per_um = 1e-6, per_deg = 1.0 / deg_per_rad;
inline constexpr std::string_view coordinates = "XYZ";

/// Adds the optional columns of time and air to the columns of a measurement.
std::vector<ColumnSpec> with_common(std::vector<ColumnSpec> columns);

void put_further_columns(Observations& obs, const Table& table, std::size_t row);

/// As `put_further_columns`, and the run, which is 1 if the table has no such column.
void put_common(Observations& obs, const Table& table, std::size_t row);

/// Appends columns for temperatures, speeds and loads of any name.
std::vector<ColumnSpec> with_channels(std::vector<ColumnSpec> columns);

/// Adds the channels of a table whose rows are readings. Error: no times, or a misspelled name.
Expected<void> put_channels(Observations& obs, const Table& table);

Observations begin(const Measurement& m, const Table& table);

Expected<Observations> complete(Observations obs);

Error at_line(std::uint64_t line, std::string column, std::string message);

/// Option `columns` with the names that the method of the measurement declares.
Expected<StatedColumns> stated_columns(const ReadInput& input);

Expected<Table> table_of(const ReadInput& input, const std::vector<ColumnSpec>& columns);

template <class T>
Expected<T> in_file(Expected<T> result, const ReadInput& input) {
  if (!result && result.error().file.empty()) result.error().file = input.measurement.file;
  return result;
}

}  // namespace nonio::csv
