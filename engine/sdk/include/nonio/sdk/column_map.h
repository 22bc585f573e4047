// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/plugin.h"

/// Options for a table of unknown format: units, sign, separator and lines of the rows. None of
/// these is guessed.
namespace nonio {

/// Adds the prefix "option unit: " for the option `unit`.
inline Error of_option(std::string_view option, std::string message) {
  Error error{"option " + std::string(option) + ": " + std::move(message)};
  error.key = option;
  return error;
}

/// Direction of travel of the rows: `plus` is toward larger coordinates, `forward` the order in
/// which the targets are listed.
enum class Way : std::uint8_t { none, plus, minus, forward, reverse };

inline Way direction_of_word(std::string_view word) {
  if (word == "+") return Way::plus;
  if (word == "-") return Way::minus;
  if (word == "forward") return Way::forward;
  return word == "reverse" || word == "backward" ? Way::reverse : Way::none;
}

/// Returns +1 or -1; `listed` is +1 if the targets are listed in ascending order, otherwise -1.
/// `way` must not be `none`.
inline std::int8_t direction_of(Way way, int listed) {
  const int sign = way == Way::plus      ? 1
                   : way == Way::minus   ? -1
                   : way == Way::forward ? listed
                                         : -listed;
  return static_cast<std::int8_t>(sign);
}

/// Returns the SI value of one unit of length (m), or of angle (rad) if `angle`; std::nullopt if
/// the name is not a unit.
inline std::optional<double> unit_named(std::string_view name, bool angle) {
  constexpr std::pair<std::string_view, double> lengths[] = {
      {"inch", 0.0254}, {"m", 1.0}, {"mm", 1e-3}, {"nm", 1e-9}, {"um", 1e-6}};
  constexpr std::pair<std::string_view, double> angles[] = {{"arcsec", 1.0 / arcsec_per_rad},
                                                            {"deg", 1.0 / deg_per_rad},
                                                            {"mrad", 1e-3},
                                                            {"rad", 1.0},
                                                            {"urad", 1e-6}};
  for (const auto& [unit, si] : angle ? angles : lengths)
    if (unit == name) return si;
  return std::nullopt;
}
constexpr const char* units_known(bool angle) {
  return angle ? "arcsec, deg, mrad, rad, urad" : "inch, m, mm, nm, um";
}

/// Returns ' ' for "blank", which means one or more blanks or tabs, and std::nullopt if the name is
/// unknown.
inline std::optional<char> separator_named(std::string_view name) {
  if (name == "tab") return '\t';
  if (name == "blank") return ' ';
  if (name == "," || name == ";" || name == "|") return name.front();
  return std::nullopt;
}

/// The lines of a table, counted from 1; last = 0 is the end of the file.
struct RowRange {
  std::uint64_t first = 1, last = 0;
  Way way = Way::none;  ///< direction of travel of all rows
};

/// Parses "12-36 forward", "41- reverse" (to the end of the file) or "5-9"; std::nullopt if the
/// text is malformed.
inline std::optional<RowRange> row_range_of(std::string_view text) {
  RowRange range;
  const std::size_t blank = text.find(' ');
  if (blank != text.npos) {
    range.way = direction_of_word(text.substr(blank + 1));
    if (range.way == Way::none) return std::nullopt;
    text = text.substr(0, blank);
  }
  const std::size_t dash = text.find('-');
  if (dash == text.npos) return std::nullopt;
  const auto whole = [](std::string_view digits, std::uint64_t& value) {
    const char* const end = digits.data() + digits.size();
    const auto read = std::from_chars(digits.data(), end, value);
    return read.ec == std::errc{} && read.ptr == end && value > 0;
  };
  if (!whole(text.substr(0, dash), range.first)) return std::nullopt;
  const std::string_view last = text.substr(dash + 1);
  if (!last.empty() && (!whole(last, range.last) || range.last < range.first)) return std::nullopt;
  return range;
}

struct TableMap {
  char separator = ' ';
  double target_unit = 0.0, value_unit = 0.0;  ///< SI value of 1 in the file, m or rad
  bool positions = false;  ///< whether the values are actual positions instead of deviations
  double sign = 1.0;       ///< sign of the deviations: +1 or -1
  double factor = 1.0, offset = 0.0;  ///< value = factor * number in SI + offset, SI
  std::vector<RowRange> tables;       ///< at least one range, in the order of the file

  /// Converts a number of the file to a deviation in SI; `target` is in SI.
  double deviation(double read, double target) const {
    const double value = factor * read * value_unit + offset;
    return positions ? value - target : sign * value;
  }
};

inline std::vector<Option> table_map_options() {
  return {
      {"values",
       std::string(),
       "",
       "What the values are.",
       {"", "actual - target", "target - actual", "positions"}},
      {"target_unit", std::string(), "", "mm, um, m, inch; deg, rad, mrad, arcsec."},
      {"value_unit", std::string(), "", "um, mm, nm, m, inch; arcsec, deg, urad, mrad, rad."},
      {"separator",
       std::string(),
       "",
       "What stands between the columns.",
       {"", ",", ";", "tab", "blank", "|"}},
      {"factor",
       1.0,
       "",
       "Each value is multiplied by it: -1 for a sensor that measures the other way round.",
       {},
       -1e6,
       1e6},
      {"offset",
       0.0,
       "",
       "Added to each value after that, in value_unit: the position where the sensor shows 0.",
       {},
       -1e9,
       1e9},
      {"first_line", std::int64_t{1}, "", "Line of the first row.", {}, 1.0, 4e9},
      {"last_line",
       std::int64_t{0},
       "",
       "Line of the last row; 0: the end of the file.",
       {},
       0.0,
       4e9},
      {"tables", std::vector<std::string>{}, "",
       "In place of first_line and last_line: the lines of each table, and how the axis went in "
       "all of it: \"12-36 forward\", \"41-65 reverse\" (or +, -)."}};
}

/// Uses the option `tables`, or `first_line` and `last_line`. Error: a range is malformed,
/// `last_line` is before `first_line`, both forms are used, or tables overlap or are not in the
/// order of the file.
inline Expected<std::vector<RowRange>> tables_of(const Settings& options) {
  std::vector<RowRange> tables;
  const RowRange all{static_cast<std::uint64_t>(options.integer("first_line", 1)),
                     static_cast<std::uint64_t>(options.integer("last_line", 0)), Way::none};
  if (all.last != 0 && all.last < all.first)
    return fail(of_option("last_line", "expected a line behind first_line, or 0 for the end"));
  for (const std::string& text : options.texts("tables")) {
    const auto range = row_range_of(text);
    if (!range)
      return fail(of_option("tables",
                            "expected the lines of a table and how the axis went, \"12-36 "
                            "forward\" (or reverse, +, -); found \"" +
                                text + "\""));
    if (!tables.empty() && (tables.back().last == 0 || tables.back().last >= range->first))
      return fail(of_option("tables",
                            "expected tables in the order of the file that do not overlap, "
                            "found \"" +
                                text + "\" behind a line of its own"));
    tables.push_back(*range);
  }
  if (tables.empty()) return std::vector<RowRange>{all};
  if (all.first != 1 || all.last != 0)
    return fail(of_option("tables", "expected tables, or first_line and last_line; found both"));
  return tables;
}

/// An error names the option that is empty or invalid.
inline Expected<TableMap> table_map_of(const Settings& options, bool rotary) {
  TableMap map;
  for (const auto& [name, unit] :
       {std::pair{"target_unit", &map.target_unit}, {"value_unit", &map.value_unit}}) {
    const auto known = unit_named(options.text(name), rotary);
    if (!known)
      return fail(of_option(name, std::string("expected one of ") + units_known(rotary) +
                                      " for this axis, found \"" + options.text(name) + "\""));
    *unit = *known;
  }
  const auto separator = separator_named(options.text("separator"));
  if (!separator)
    return fail(
        of_option("separator", "expected one of \",\" \";\" \"tab\" \"blank\" \"|\", found \"" +
                                   options.text("separator") + "\""));
  map.separator = *separator;
  const std::string values = options.text("values");
  map.positions = values == "positions";
  map.sign = values == "target - actual" ? -1.0 : 1.0;
  if (!map.positions && map.sign > 0.0 && values != "actual - target")
    return fail(
        of_option("values",
                  "expected what the values are, \"actual - target\", \"target - actual\" or "
                  "\"positions\"; found \"" +
                      values + "\". A sign is not guessed"));
  map.factor = options.number("factor", 1.0);
  if (map.factor == 0.0) return fail(of_option("factor", "expected a number other than 0"));
  map.offset = options.number("offset") * map.value_unit;
  NONIO_TRY(auto tables, tables_of(options));
  map.tables = std::move(tables);
  return map;
}

}  // namespace nonio
