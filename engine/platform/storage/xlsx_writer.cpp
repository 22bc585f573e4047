// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/xlsx_writer.h"

#include <xlsxwriter.h>

#include <array>
#include <chrono>
#include <cmath>

#include "platform/storage/late_library.h"

namespace nonio::storage {

namespace {

/// Creation time if no date is stated: 1980-01-01, the first day that a ZIP archive can store.
constexpr std::time_t no_day = 315532800;
constexpr std::array<lxw_color_t, 6> colours{0x1B6CA8, 0xC8553D, 0x4D8B31,
                                             0x7A4FA3, 0x8A6D1D, 0x4A4A4A};
constexpr std::size_t chart_rows = 22;
constexpr std::uint16_t chart_width = 900, chart_height = 420;

/// Returns std::nullopt before 1900-03-01, because spreadsheets count the day 1900-02-29, which did
/// not exist.
std::optional<std::chrono::year_month_day> day_of(const std::string& text) {
  int year = 0;
  unsigned month = 0, day = 0;
  int end = 0;
  if (std::sscanf(text.c_str(), "%4d-%2u-%2u%n", &year, &month, &day, &end) != 3 ||
      static_cast<std::size_t>(end) != text.size())
    return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
  using namespace std::chrono_literals;
  if (!date.ok() || date < 1900y / 3 / 1 || date > 9999y / 12 / 31) return std::nullopt;
  return date;
}

bool is_hexadecimal(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

/// "_x0041_" would be read as "A" (ECMA-376 part 1, 22.9.2.19), so its first underscore is escaped.
std::string escaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool sequence = text[i] == '_' && i + 6 < text.size() && text[i + 1] == 'x' &&
                          is_hexadecimal(text[i + 2]) && is_hexadecimal(text[i + 3]) &&
                          is_hexadecimal(text[i + 4]) && is_hexadecimal(text[i + 5]) &&
                          text[i + 6] == '_';
    out += sequence ? "_x005F_" : std::string(1, text[i]);
  }
  return out;
}

struct Formats {
  lxw_format *bold = nullptr, *day = nullptr;
};

class First {
 public:
  void operator()(lxw_error error) {
    if (error_ == LXW_NO_ERROR) error_ = error;
  }
  lxw_error error() const { return error_; }

 private:
  lxw_error error_ = LXW_NO_ERROR;
};

void write_cell(lxw_worksheet* sheet, lxw_row_t row, lxw_col_t column, const Cell& cell, bool bold,
                const Formats& formats, First& first) {
  lxw_format* const format = bold ? formats.bold : nullptr;
  const auto text = [&](const std::string& value) {
    first(worksheet_write_string(sheet, row, column, escaped(value).c_str(), format));
  };
  if (const auto* number = std::get_if<double>(&cell)) {
    if (std::isfinite(*number)) first(worksheet_write_number(sheet, row, column, *number, format));
  } else if (const auto* string = std::get_if<std::string>(&cell)) {
    if (!string->empty()) text(*string);
  } else if (const auto* day = std::get_if<Day>(&cell)) {
    const auto date = day_of(day->text);
    if (!date) return text(day->text);
    lxw_datetime value{};
    value.year = int(date->year());
    value.month = static_cast<int>(unsigned(date->month()));
    value.day = static_cast<int>(unsigned(date->day()));
    first(worksheet_write_datetime(sheet, row, column, &value, formats.day));
  }
}

void set_widths(lxw_worksheet* sheet, const Sheet& rows, First& first) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows.rows)
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (widths.size() <= k) widths.resize(k + 1, 9);
      const auto* text = std::get_if<std::string>(&row[k]);
      widths[k] = std::max(widths[k], text != nullptr ? text->size() + 1
                                      : std::holds_alternative<std::monostate>(row[k]) ? 0
                                                                                       : 13);
    }
  for (std::size_t k = 0; k < widths.size(); ++k)
    first(worksheet_set_column(sheet, static_cast<lxw_col_t>(k), static_cast<lxw_col_t>(k),
                               static_cast<double>(std::min<std::size_t>(widths[k], 60)), nullptr));
}

void add_curve(lxw_chart* chart, const Chart::Curve& curve, lxw_color_t colour) {
  lxw_chart_series* const series = chart_add_series(chart, nullptr, nullptr);
  const auto row = [](std::size_t r) { return static_cast<lxw_row_t>(r); };
  const auto column = [](std::size_t c) { return static_cast<lxw_col_t>(c); };
  chart_series_set_categories(series, curve.sheet.c_str(), row(curve.first_row),
                              column(curve.position_column), row(curve.last_row),
                              column(curve.position_column));
  chart_series_set_values(series, curve.sheet.c_str(), row(curve.first_row),
                          column(curve.value_column), row(curve.last_row),
                          column(curve.value_column));
  chart_series_set_name(series, curve.name.c_str());
  lxw_chart_line line{};
  line.color = colour;
  line.width = 1.5;
  lxw_chart_fill fill{};
  fill.color = colour;
  if (curve.line) {
    chart_series_set_line(series, &line);
  } else {
    lxw_chart_line none{};
    none.none = LXW_TRUE;
    chart_series_set_line(series, &none);
  }
  chart_series_set_marker_type(series,
                               curve.line ? LXW_CHART_MARKER_CIRCLE : LXW_CHART_MARKER_DIAMOND);
  chart_series_set_marker_size(series, curve.line ? 5 : 4);
  chart_series_set_marker_fill(series, &fill);
  line.width = 0.75;
  chart_series_set_marker_line(series, &line);
  if (!curve.U) return;
  chart_series_set_error_bars(series->y_error_bars, LXW_CHART_ERROR_BAR_TYPE_FIXED, *curve.U);
  chart_series_set_error_bars_line(series->y_error_bars, &line);
}

void add_chart(lxw_workbook* book, lxw_worksheet* sheet, const Chart& chart, std::size_t row,
               First& first) {
  lxw_chart* const drawn = workbook_add_chart(book, LXW_CHART_SCATTER_STRAIGHT_WITH_MARKERS);
  if (drawn == nullptr) return first(LXW_ERROR_MEMORY_MALLOC_FAILED);
  for (std::size_t k = 0; k < chart.curves.size(); ++k)
    add_curve(drawn, chart.curves[k], colours[k % colours.size()]);
  chart_title_set_name(drawn, chart.title.c_str());
  chart_axis_set_name(drawn->x_axis, chart.position_name.c_str());
  chart_axis_set_name(drawn->y_axis, chart.value_name.c_str());
  chart_axis_set_label_position(drawn->x_axis, LXW_CHART_AXIS_LABEL_POSITION_LOW);
  lxw_chart_options options{};
  options.x_scale = chart_width / 480.0;  // 480 x 288 is the default size in the library
  options.y_scale = chart_height / 288.0;
  first(worksheet_insert_chart_opt(sheet, static_cast<lxw_row_t>(row), 0, drawn, &options));
}

void add_sheet(lxw_workbook* book, const Sheet& sheet, const Formats& formats, First& first) {
  lxw_worksheet* const added = workbook_add_worksheet(book, sheet.name.c_str());
  if (added == nullptr) return first(LXW_ERROR_PARAMETER_VALIDATION);
  set_widths(added, sheet, first);
  std::vector<char> bold(sheet.rows.size(), 0);
  for (const std::size_t heading : sheet.headings) bold[heading] = 1;
  for (std::size_t r = 0; r < sheet.rows.size(); ++r)
    for (std::size_t k = 0; k < sheet.rows[r].size(); ++k)
      write_cell(added, static_cast<lxw_row_t>(r), static_cast<lxw_col_t>(k), sheet.rows[r][k],
                 bold[r] != 0, formats, first);
  worksheet_set_landscape(added);
  worksheet_set_paper(added, 9);
  worksheet_fit_to_pages(added, 1, 0);
  if (sheet.frozen > 0) worksheet_freeze_panes(added, static_cast<lxw_row_t>(sheet.frozen), 0);
  for (std::size_t k = 0; k < sheet.charts.size(); ++k)
    add_chart(book, added, sheet.charts[k], sheet.rows.size() + 1 + k * chart_rows, first);
}

Expected<void> write(const Workbook& book, const std::filesystem::path& file,
                     const std::filesystem::path& temporary_folder) {
  std::string folder = temporary_folder.string(), title = book.title;
  lxw_workbook_options options{};
  options.tmpdir = folder.data();
  lxw_workbook* const written = workbook_new_opt(file.c_str(), &options);
  if (written == nullptr) return fail("there is not enough memory for the workbook");
  Formats formats{workbook_add_format(written), workbook_add_format(written)};
  format_set_bold(formats.bold);
  format_set_num_format(formats.day, "yyyy-mm-dd");
  lxw_doc_properties properties{};
  properties.title = title.data();
  const auto day = day_of(book.date);
  properties.created =
      day ? std::chrono::system_clock::to_time_t(std::chrono::sys_days(*day)) : no_day;
  First first;
  first(workbook_set_properties(written, &properties));
  for (const Sheet& sheet : book.sheets) add_sheet(written, sheet, formats, first);
  first(workbook_close(written));
  if (first.error() != LXW_NO_ERROR)
    return fail("the workbook cannot be written: " + std::string(lxw_strerror(first.error())));
  return {};
}

}  // namespace

}  // namespace nonio::storage

NONIO_EXPORTED const nonio::storage::XlsxWriter nonio_xlsx;
const nonio::storage::XlsxWriter nonio_xlsx{nonio::storage::write};
