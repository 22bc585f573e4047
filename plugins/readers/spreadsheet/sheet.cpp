// SPDX-License-Identifier: Apache-2.0
#include "sheet.h"

#include <chrono>
#include <cmath>
#include <cstdio>

namespace nonio::spreadsheet {

Expected<void> Sheet::put(std::size_t row, std::size_t column, std::string text) {
  if (text.empty() || row >= most_rows) return {};
  if (column >= most_columns || row >= most_cells || (cells_ += text.size() / 64 + 1) > most_cells)
    return fail("sheet \"" + name + "\": expected up to 1000 columns and 20 million cells");
  if (rows_.size() <= row) rows_.resize(row + 1);
  if (rows_[row].size() <= column) rows_[row].resize(column + 1);
  rows_[row][column] = std::move(text);
  return {};
}

std::string date_text(double days, bool has_day) {
  constexpr double seconds_of_day = 86400.0;
  if (!(std::fabs(days) < 3e6)) return "#DATE";
  const auto all = static_cast<long long>(std::llround(days * seconds_of_day));
  const long long day = all >= 0 ? all / 86400 : (all - 86399) / 86400, seconds = all - day * 86400;
  char text[64];
  if (!has_day) {
    std::snprintf(text, sizeof text, "%02lld:%02lld:%02lld", all / 3600, all / 60 % 60, all % 60);
    return text;
  }
  using namespace std::chrono;
  const year_month_day date = sys_days(year(1899) / December / 30) + std::chrono::days(day);
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02lld:%02lld:%02lld",
                static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), seconds / 3600, seconds / 60 % 60, seconds % 60);
  return text;
}

}  // namespace nonio::spreadsheet
