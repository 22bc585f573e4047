// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// A date YYYY-MM-DD. Invalid dates and dates before 1900-03-01, which spreadsheets represent
/// differently, are written as text.
struct Day {
  std::string text;
};

/// A non-finite number is written as a blank cell; text is never interpreted as a formula.
using Cell = std::variant<std::monostate, double, std::string, Day>;

/// A chart of curves, each with a column of positions. Rows and columns are counted from 0.
struct Chart {
  struct Curve {
    std::string name, sheet;
    std::size_t position_column = 0, value_column = 0, first_row = 0, last_row = 0;
    bool line = true;  ///< whether the points are connected by a line
    /// Expanded uncertainty in the unit of the values; drawn as error bars if stated.
    std::optional<double> U = {};
  };
  std::string title, position_name, value_name;
  std::vector<Curve> curves;
};

struct Sheet {
  /// Must be a valid and unique name, as `sheet_name` returns it.
  std::string name;
  std::vector<std::vector<Cell>> rows{};
  std::vector<std::size_t> headings{};  ///< indices of the rows in bold
  std::size_t frozen = 0;               ///< number of rows at the top that stay visible
  std::vector<Chart> charts{};          ///< placed one below another and below the rows
};

struct Workbook {
  std::string title;
  /// Creation date YYYY-MM-DD, stated so that the same workbook gives the same bytes.
  std::string date;
  std::vector<Sheet> sheets;
};

inline constexpr std::size_t most_sheet_rows = 1'048'576, most_sheet_columns = 16'384,
                             most_cell_characters = 32'767;

/// Returns `name` as a valid new sheet name of `book`: up to 31 characters, none of []:*?/\, no
/// apostrophe at either end, different from the names of its other sheets.
std::string sheet_name(const Workbook& book, const std::string& name);

/// Returns the XLSX file. Errors: more rows or columns than the format allows; a text longer than a
/// cell can contain; no space for temporary files.
Expected<std::string> xlsx_bytes(const Workbook& book);

}  // namespace nonio::storage
