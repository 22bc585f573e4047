// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::spreadsheet {

inline constexpr std::size_t most_cells = 20'000'000, most_columns = 1000;
inline constexpr std::size_t all_rows = static_cast<std::size_t>(-1);

/// The cells of a sheet as text: stored numbers with a decimal point, dates as 2026-11-03T08:30:00,
/// durations as 08:30:00, errors such as #N/A. Only the first cell of merged cells has text.
class Sheet {
 public:
  std::string name;
  std::size_t most_rows = all_rows;  ///< later rows are omitted
  const std::vector<std::vector<std::string>>& rows() const { return rows_; }
  /// Row and column count from 0. Error: limits exceeded.
  Expected<void> put(std::size_t row, std::size_t column, std::string text);

 private:
  std::vector<std::vector<std::string>> rows_;
  std::size_t cells_ = 0;
};

/// `days` since 1899-12-30; without `has_day`, a duration.
std::string date_text(double days, bool has_day);

struct Book {
  std::vector<Sheet> sheets;
};

bool is_ods(std::string_view archive);
/// `most_rows` is per sheet.
Expected<Book> read_xlsx(std::string_view archive, std::size_t most_rows = all_rows);
Expected<Book> read_ods(std::string_view archive, std::size_t most_rows = all_rows);

}  // namespace nonio::spreadsheet
