// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "nonio/sdk/error.h"

/// A spreadsheet as a value, and its bytes as XLSX (ECMA-376).
namespace nonio::storage {

/// YYYY-MM-DD, written as a date of the spreadsheet; text if it is no day from 1900 on.
struct Day {
  std::string text;
};

/// A number that is not finite is written as a blank cell; a text is never read as a formula.
using Cell = std::variant<std::monostate, double, std::string, Day>;

/// A native chart of curves, each over a column of positions; rows and columns from 0.
struct Chart {
  struct Curve {
    std::string name, sheet;
    std::size_t position_column = 0, value_column = 0, first_row = 0, last_row = 0;
    bool line = true;              ///< else points without a line
    std::optional<double> U = {};  ///< drawn as error bars
  };
  std::string title, position_name, value_name;
  std::vector<Curve> curves;
};

struct Sheet {
  std::string name;  ///< `write` makes it a name that spreadsheets accept; see `sheet_names`
  std::vector<std::vector<Cell>> rows{};
  std::vector<std::size_t> headings{};  ///< rows in bold
  std::size_t frozen = 0;               ///< rows that stay visible
  std::vector<Chart> charts{};          ///< one below the other, below the rows
};

struct Workbook {
  std::string title;
  std::string date;  ///< YYYY-MM-DD, of the properties: the same workbook has the same bytes
  std::vector<Sheet> sheets;
};

inline constexpr std::size_t most_sheet_rows = 1'048'576, most_sheet_columns = 16'384,
                             most_cell_characters = 32'767;

/// `name` as a sheet of `book` may be called: up to 31 characters, none of []:*?/\, no apostrophe at
/// an end, another one than those of its sheets.
std::string sheet_name(const Workbook& book, const std::string& name);

/// Errors: a sheet with more rows or columns than the format has, a text that is longer than a cell
/// takes; no room for temporary files. The charts name sheets by their names in `book`.
Expected<std::string> xlsx_bytes(const Workbook& book);

}  // namespace nonio::storage
