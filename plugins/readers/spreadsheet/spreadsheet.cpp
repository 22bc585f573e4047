// SPDX-License-Identifier: Apache-2.0
#include "spreadsheet.h"

#include <algorithm>
#include <iterator>

#include "csv.h"
#include "header.h"
#include "nonio/sdk/format.h"
#include "rows.h"
#include "sheet.h"

namespace nonio::spreadsheet {

namespace {

using Row = std::vector<std::string>;

/// Line breaks are frequent in column names.
std::string in_one_line(std::string cell) {
  for (char& c : cell)
    if (c == '\t' || c == '\n' || c == '\r') c = ' ';
  return cell;
}

/// Fields are separated by tabs. There are at least `width`, because a sheet omits blank cells at
/// the end of a row.
std::string line_of(const Row& row, std::size_t width = 0) {
  std::string out;
  for (std::size_t k = 0; k < std::max(row.size(), width); ++k) {
    if (k > 0) out += '\t';
    if (k < row.size()) out += in_one_line(row[k]);
  }
  return out;
}

bool is_blank(const Row& row) {
  return std::all_of(row.begin(), row.end(), [](const std::string& cell) {
    return cell.find_first_not_of(" \t\r\n") == cell.npos;
  });
}

/// Known column names: of csv, the method, or the option.
struct Wanted {
  const Method* method = nullptr;
  csv::StatedColumns stated{};
};

bool is_header(const Row& row, const Wanted& wanted) {
  if (is_blank(row)) return false;
  if (!wanted.stated.empty()) {
    Row names;
    std::transform(row.begin(), row.end(), std::back_inserter(names), in_one_line);
    return wanted.stated.all_in(std::vector<std::string_view>(names.begin(), names.end()));
  }
  const Method* const method = wanted.method;
  if (method == nullptr || method->columns.empty()) return csv::recognises(line_of(row) + "\n");
  return std::any_of(row.begin(), row.end(), [&](const std::string& cell) {
    return std::any_of(method->columns.begin(), method->columns.end(), [&](const auto& column) {
      return cell == column.name || cell.starts_with(column.name + "_");
    });
  });
}

struct Table {
  const Sheet* sheet = nullptr;
  std::size_t first = 0, after = 0;
};

Table table_of(const Sheet& sheet, const Wanted& wanted) {
  const auto& rows = sheet.rows();
  const auto header = std::find_if(rows.begin(), rows.end(),
                                   [&](const Row& row) { return is_header(row, wanted); });
  if (header == rows.end()) return {};
  const auto end = std::find_if(header, rows.end(), is_blank);
  return {&sheet, static_cast<std::size_t>(header - rows.begin()),
          static_cast<std::size_t>(end - rows.begin())};
}

std::string names_of(const std::vector<Sheet>& sheets) {
  std::string out;
  for (const Sheet& sheet : sheets) out += (out.empty() ? "\"" : ", \"") + sheet.name + "\"";
  return out;
}

Expected<Table> chosen(const Book& book, const ReadInput& input) {
  const std::string wanted = input.options.text("sheet");
  NONIO_TRY(auto stated, csv::stated_columns(input));
  const Wanted names{input.method, std::move(stated)};
  std::vector<Table> found;
  for (const Sheet& sheet : book.sheets) {
    if (!wanted.empty() && sheet.name != wanted) continue;
    const Table table = table_of(sheet, names);
    if (table.sheet != nullptr) found.push_back(table);
  }
  if (found.size() == 1) return found.front();
  const std::string option = "[options.spreadsheet] sheet";
  if (found.size() > 1) {
    std::vector<Sheet> several;
    for (const Table& t : found) several.push_back(*t.sheet);
    return fail("expected one sheet with readings, found " + names_of(several) + "; name one in " +
                option);
  }
  if (!wanted.empty() && std::none_of(book.sheets.begin(), book.sheets.end(),
                                      [&](const Sheet& s) { return s.name == wanted; }))
    return fail(option + ": there is no sheet \"" + wanted + "\"; found " + names_of(book.sheets));
  return fail("no row with the names of columns was found in " +
              (wanted.empty() ? names_of(book.sheets) : "\"" + wanted + "\"") + "; expected " +
              (names.stated.empty() ? "names such as target_mm and deviation_um"
                                    : names.stated.list() + " (option columns)"));
}

}  // namespace

Expected<std::vector<Row>> first_rows(std::string_view bytes, std::size_t most) {
  constexpr std::size_t titles = 200;
  const auto book =
      is_ods(bytes) ? read_ods(bytes, titles + most) : read_xlsx(bytes, titles + most);
  if (!book) return fail(book.error());
  // Titles precede the table, so the preview begins at the fullest row of the longest sheet.
  const auto longest = std::max_element(
      book->sheets.begin(), book->sheets.end(),
      [](const Sheet& a, const Sheet& b) { return a.rows().size() < b.rows().size(); });
  if (longest == book->sheets.end()) return std::vector<Row>();
  const auto cells = [](const Row& row) {
    return std::count_if(row.begin(), row.end(), [](const auto& cell) { return !cell.empty(); });
  };
  const auto& rows = longest->rows();
  const auto first = std::max_element(
      rows.begin(), rows.end(), [&](const Row& a, const Row& b) { return cells(a) < cells(b); });
  std::vector<Row> out;
  for (auto row = first; row != rows.end() && out.size() < most; ++row)
    std::transform(row->begin(), row->end(), std::back_inserter(out.emplace_back()), in_one_line);
  return out;
}

bool recognises(std::string_view head) { return head.starts_with("PK\x03\x04"); }

Expected<Observations> read(const ReadInput& input) {
  NONIO_TRY(const auto book, is_ods(input.bytes) ? read_ods(input.bytes) : read_xlsx(input.bytes));
  NONIO_TRY(const Table table, chosen(book, input));
  const auto& rows = table.sheet->rows();
  std::string text;
  std::size_t width = rows[table.first].size();
  // Columns at the end may have no names.
  if (!input.options.texts(csv::columns_option).empty())
    for (std::size_t r = table.first; r < table.after; ++r) width = std::max(width, rows[r].size());
  for (std::size_t r = 0; r < table.after; ++r)
    text += (r < table.first ? "#" : line_of(rows[r], width)) + "\n";
  const ReadInput as_csv{.bytes = text,
                         .campaign = input.campaign,
                         .measurement = input.measurement,
                         .options = input.options,
                         .method = input.method};
  auto read = csv::read(as_csv);
  if (!read) {
    Error error = read.error();
    error.message = "sheet \"" + table.sheet->name + "\": " + error.message;
    return fail(std::move(error));
  }
  const bool more = std::any_of(rows.begin() + static_cast<std::ptrdiff_t>(table.after), rows.end(),
                                [](const Row& row) { return !is_blank(row); });
  read->notes.push_back({more ? "spreadsheet.rows-below" : "spreadsheet.sheet",
                         {{"first", static_cast<double>(table.first + 1), Quantity::count},
                          {"last", static_cast<double>(table.after), Quantity::count}},
                         {{"sheet", table.sheet->name}}});
  return read;
}

}  // namespace nonio::spreadsheet
