// SPDX-License-Identifier: Apache-2.0
#include "column_map.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "runs.h"

namespace nonio::wide_table {
using namespace reading;
using Role = Column::Role;
using Way = Column::Way;

namespace {

const char* const roles_help =
    "\"target\", \"ignore\", a run and how it went (\"1 +\", \"1 -\", or \"1 forward\", \"1 "
    "reverse\": as the targets are listed), or of a print \"mean +\", \"mean -\", \"2s +\", \"2s "
    "-\" (or forward, reverse), \"mean\", \"dead zone\"";

Way way_of(std::string_view word) {
  if (word == "+") return Way::plus;
  if (word == "-") return Way::minus;
  if (word == "forward") return Way::forward;
  return word == "reverse" ? Way::reverse : Way::none;
}

Expected<Column> column_of(const std::string& text) {
  const auto words = by_blanks(text);
  const auto wrong = [&] {
    return fail(
        of_option("columns", std::string("wanted ") + roles_help + "; found " + shown(text)));
  };
  if (words.size() == 1 && words[0] == "target") return Column{Role::target};
  if (words.size() == 1 && words[0] == "ignore") return Column{Role::ignore};
  if (words.size() == 1 && words[0] == "mean") return Column{Role::both};
  if (words.size() != 2) return wrong();
  if (words[0] == "dead" && words[1] == "zone") return Column{Role::dead_zone};
  Column column;
  column.way = way_of(words[1]);
  if (column.way == Way::none) return wrong();
  if (words[0] == "mean" || words[0] == "2s") {
    column.role = words[0] == "mean" ? Role::mean : Role::two_sigma;
    return column;
  }
  column.role = Role::reading;
  column.run = whole_number(words[0], 10000);
  if (column.run == 0) return wrong();
  return column;
}

Expected<std::vector<Column>> columns_of(const std::vector<std::string>& texts) {
  if (texts.empty())
    return fail(of_option("columns", std::string("wanted what each column is: ") + roles_help +
                                         "; found none. A table does not say it, and it is not "
                                         "guessed"));
  std::vector<Column> columns;
  std::set<std::tuple<Role, Way, std::uint32_t>> seen;
  bool readings = false, means = false;
  for (const std::string& text : texts) {
    const auto column = column_of(text);
    if (!column) return fail(column.error());
    if (column->role != Role::ignore &&
        !seen.insert({column->role, column->way, column->run}).second)
      return fail(of_option("columns", "wanted \"" + text + "\" once, found it twice"));
    readings = readings || column->role == Role::reading;
    means = means || column->role == Role::mean;
    columns.push_back(*column);
  }
  if (!seen.contains({Role::target, Way::none, 0}))
    return fail(of_option("columns", "wanted one \"target\", found none"));
  if (readings == means)
    return fail(
        of_option("columns", readings ? "wanted runs or means, found both; which of them count?"
                                      : "wanted at least one run (\"1 +\") or mean (\"mean +\")"));
  return columns;
}

Expected<double> unit_of_option(const Settings& options, const char* name,
                                const std::map<std::string, double, std::less<>>& units) {
  const auto found = units.find(options.text(name));
  if (found != units.end()) return found->second;
  std::string list;
  for (const auto& [unit, value] : units) list += (list.empty() ? "" : ", ") + unit;
  return fail(of_option(
      name, "wanted one of " + list + " for this axis, found \"" + options.text(name) + "\""));
}

Expected<char> separator_of(const Settings& options) {
  const std::string name = options.text("separator");
  static const std::map<std::string, char, std::less<>> separators{
      {",", ','}, {";", ';'}, {"tab", '\t'}, {"blank", ' '}, {"|", '|'}};
  const auto found = separators.find(name);
  if (found != separators.end()) return found->second;
  return fail(of_option(
      "separator", "wanted one of \",\" \";\" \"tab\" \"blank\" \"|\", found \"" + name + "\""));
}

Expected<void> take_values(const Settings& options, Map& map) {
  const std::string values = options.text("values");
  if (values == "positions") {
    map.positions = true;
  } else if (values == "target - actual") {
    map.sign = -1.0;
  } else if (values != "actual - target") {
    return fail(of_option("values",
                          "wanted what the values are, \"actual - target\", \"target - actual\" or "
                          "\"positions\"; found \"" +
                              values + "\". A sign is not guessed"));
  }
  if (map.positions && map.means())
    return fail(of_option("values", "wanted deviations in a table of means, found positions"));
  return {};
}

}  // namespace

bool Map::means() const {
  return std::any_of(columns.begin(), columns.end(),
                     [](const Column& c) { return c.role == Role::mean; });
}

Expected<Map> map_of(const Settings& options, bool rotary) {
  static const std::map<std::string, double, std::less<>> lengths{
      {"m", 1.0}, {"mm", 1e-3}, {"um", 1e-6}, {"nm", 1e-9}, {"inch", 0.0254}},
      angles{{"deg", 1.0 / deg_per_rad},
             {"rad", 1.0},
             {"mrad", 1e-3},
             {"urad", 1e-6},
             {"arcsec", 1.0 / arcsec_per_rad}};
  Map map;
  auto columns = columns_of(options.texts("columns"));
  if (!columns) return fail(columns.error());
  map.columns = std::move(*columns);
  const auto target = unit_of_option(options, "target_unit", rotary ? angles : lengths),
             value = unit_of_option(options, "value_unit", rotary ? angles : lengths);
  if (!target) return fail(target.error());
  if (!value) return fail(value.error());
  map.target_unit = *target;
  map.value_unit = *value;
  const auto separator = separator_of(options);
  if (!separator) return fail(separator.error());
  map.separator = *separator;
  if (auto ok = take_values(options, map); !ok) return fail(ok.error());
  map.first_line = static_cast<std::uint64_t>(options.integer("first_line", 1));
  map.last_line = static_cast<std::uint64_t>(options.integer("last_line", 0));
  if (map.last_line != 0 && map.last_line < map.first_line)
    return fail(of_option("last_line", "wanted a line behind first_line, or 0 for the end"));
  return map;
}

}  // namespace nonio::wide_table
