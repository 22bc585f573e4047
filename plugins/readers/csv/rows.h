// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "nonio/sdk/plugin.h"
#include "table.h"

/// What the layouts of spatial.h have in common: units, columns of time and air, errors with their place.
namespace nonio::csv {

using Kind = ColumnSpec::Kind;
using Sense = std::array<double, 3>;

inline constexpr double per_mm = 1e-3, per_um = 1e-6, per_deg = 1.0 / deg_per_rad;
inline constexpr std::string_view coordinates = "XYZ";

/// And columns of time and air that every kind may have.
std::vector<ColumnSpec> with_common(std::vector<ColumnSpec> columns);

/// Of a reading: time and air, from row `row` of the table, and the line of the file.
void put_further_columns(Observations& obs, const Table& table, std::size_t row);

/// The same, and its run: 1 where the table has none.
void put_common(Observations& obs, const Table& table, std::size_t row);

Observations begin(const Measurement& m, const Table& table);

/// An error if no reading was taken.
Expected<Observations> complete(Observations obs);

Error at_line(std::uint64_t line, std::string column, std::string message);

Expected<Table> table_of(const ReadInput& input, const std::vector<ColumnSpec>& columns);

/// An error without a file is one of the file that was read.
template <class T>
Expected<T> in_file(Expected<T> result, const ReadInput& input) {
  if (!result && result.error().file.empty()) result.error().file = input.measurement.file;
  return result;
}

}  // namespace nonio::csv
