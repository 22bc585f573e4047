// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::spreadsheet {

inline constexpr std::size_t most_cells = 20'000'000, most_columns = 1000;
inline constexpr std::size_t all_rows = static_cast<std::size_t>(-1);

/// The cells of one sheet as text: numbers as they are stored, with a point; dates as 2026-11-03T08:30:00,
/// durations as 08:30:00; errors (#N/A) as they are shown; cells below a merged one blank.
class Sheet {
 public:
  std::string name;
  std::size_t most_rows = all_rows;  ///< what comes after them is left out
  const std::vector<std::vector<std::string>>& rows() const { return rows_; }
  /// Row and column from 0. An error beyond the limits.
  Expected<void> put(std::size_t row, std::size_t column, std::string text);

 private:
  std::vector<std::vector<std::string>> rows_;
  std::size_t cells_ = 0;
};

/// Days since 1899-12-30 as a date, or, if the format shows no day, as a duration.
std::string date_text(double days, bool has_day);

/// The sheets of a workbook, in its order.
struct Book {
  std::vector<Sheet> sheets;
};

bool is_ods(std::string_view archive);
/// Of each sheet up to `most_rows` rows.
Expected<Book> read_xlsx(std::string_view archive, std::size_t most_rows = all_rows);
Expected<Book> read_ods(std::string_view archive, std::size_t most_rows = all_rows);

}  // namespace nonio::spreadsheet
