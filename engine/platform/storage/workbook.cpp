// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/workbook.h"

#include <algorithm>

#include "platform/storage/characters.h"
#include "platform/storage/files.h"
#include "platform/storage/late_library.h"
#include "platform/storage/xlsx_writer.h"

namespace nonio::storage {

namespace {

constexpr std::size_t most_name_characters = 31;

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// Returns the first `most` characters, counted in UTF-16 as spreadsheets do. Characters that a
/// sheet name must not contain become '_'; bytes that are not UTF-8 are omitted.
std::string plain_name(std::string_view name, std::size_t most) {
  std::string out;
  for (std::size_t count = 0; !name.empty();) {
    const Character c = first_of(name);
    if (c.size == 0) {
      name.remove_prefix(1);
      continue;
    }
    count += c.code > 0xFFFF ? 2 : 1;
    if (count > most) break;
    const bool allowed =
        is_shown(c.code) &&
        (c.code > 0x7F ||
         std::string_view("[]:*?/\\").find(static_cast<char>(c.code)) == std::string_view::npos);
    if (allowed)
      out += name.substr(0, c.size);
    else
      out += '_';
    name.remove_prefix(c.size);
  }
  if (out.starts_with('\'')) out.front() = '_';
  if (out.ends_with('\'')) out.back() = '_';
  return out.empty() ? "_" : out;
}

/// The number of code points, which is at most the length in UTF-16.
std::size_t characters_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

Expected<void> check(const Sheet& sheet) {
  const std::string which = "sheet \"" + sheet.name + "\"";
  if (sheet.rows.size() > most_sheet_rows)
    return fail(which + " would have " + std::to_string(sheet.rows.size()) +
                " rows; a spreadsheet has 1,048,576. The output csv of `nonio run` has no limit");
  for (std::size_t r = 0; r < sheet.rows.size(); ++r) {
    if (sheet.rows[r].size() > most_sheet_columns)
      return fail(which + " would have " + std::to_string(sheet.rows[r].size()) +
                  " columns; a spreadsheet has 16,384. The output csv of `nonio run` has no limit");
    for (const Cell& cell : sheet.rows[r])
      if (const auto* text = std::get_if<std::string>(&cell);
          text != nullptr && characters_of(*text) > most_cell_characters)
        return fail(which + ", row " + std::to_string(r + 1) +
                    ": a text is longer than the 32,767 characters of a cell");
  }
  return {};
}

}  // namespace

std::string sheet_name(const Workbook& book, const std::string& name) {
  for (int k = 1;; ++k) {
    const std::string more = k == 1 ? "" : " " + std::to_string(k);
    const std::string tried = plain_name(name, most_name_characters - more.size()) + more;
    if (std::none_of(book.sheets.begin(), book.sheets.end(),
                     [&](const Sheet& s) { return lower(s.name) == lower(tried); }))
      return tried;
  }
}

Expected<std::string> xlsx_bytes(const Workbook& book) {
  for (const Sheet& sheet : book.sheets)
    if (const auto fits = check(sheet); !fits) return fail(fits.error());
  NONIO_TRY(const auto* writer, exported_as<XlsxWriter>("libnonio_xlsx.so", "nonio_xlsx"));
  const ScratchFolder folder("xlsx");
  if (folder.path().empty())
    return fail("no folder for temporary files could be made; expected room in TMPDIR or /tmp");
  const std::filesystem::path file = folder.path() / "workbook";
  if (const auto written = writer->write(book, file, folder.path()); !written)
    return fail(written.error());
  return read_file(file);
}

}  // namespace nonio::storage
