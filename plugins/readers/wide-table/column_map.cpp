// SPDX-License-Identifier: Apache-2.0
#include "column_map.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "runs.h"

namespace nonio::wide_table {
using namespace readers;
using Role = Column::Role;

namespace {

const char* const roles_help =
    "\"target\", \"ignore\", a run and how it went (\"1 +\", \"1 -\", or \"1 forward\", \"1 "
    "reverse\": as the targets are listed; \"1\" where option tables states how it went), or of a "
    "print \"mean +\", \"mean -\", \"2s +\", \"2s "
    "-\" (or forward, reverse), \"mean\", \"dead zone\"";

Expected<Column> column_of(const std::string& text) {
  const auto words = by_blanks(text);
  const auto wrong = [&] {
    return fail(
        of_option("columns", std::string("expected ") + roles_help + "; found " + shown(text)));
  };
  if (words.size() == 1 && words[0] == "target") return Column{Role::target};
  if (words.size() == 1 && words[0] == "ignore") return Column{Role::ignore};
  if (words.size() == 1 && words[0] == "mean") return Column{Role::both};
  if (words.size() == 1 && whole_number(words[0], 10000) != 0)
    return Column{Role::reading, Way::none, whole_number(words[0], 10000)};
  if (words.size() != 2) return wrong();
  if (words[0] == "dead" && words[1] == "zone") return Column{Role::dead_zone};
  Column column;
  column.way = direction_of_word(words[1]);
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
    return fail(of_option("columns", std::string("expected what each column is: ") + roles_help +
                                         "; found none. A table does not state it, and it is not "
                                         "guessed"));
  std::vector<Column> columns;
  std::set<std::tuple<Role, Way, std::uint32_t>> seen;
  bool readings = false, means = false;
  for (const std::string& text : texts) {
    const auto column = column_of(text);
    if (!column) return fail(column.error());
    if (column->role != Role::ignore &&
        !seen.insert({column->role, column->way, column->run}).second)
      return fail(of_option("columns", "expected \"" + text + "\" once, found it twice"));
    readings = readings || column->role == Role::reading;
    means = means || column->role == Role::mean;
    columns.push_back(*column);
  }
  if (!seen.contains({Role::target, Way::none, 0}))
    return fail(of_option("columns", "expected one \"target\", found none"));
  if (readings == means)
    return fail(of_option("columns",
                          readings ? "expected runs or means, found both; which of them count?"
                                   : "expected at least one run (\"1 +\") or mean (\"mean +\")"));
  return columns;
}

/// Each run has its way, of its column or of its table, and not of both.
Expected<void> check_ways(const Map& map) {
  for (const Column& c : map.columns)
    for (const RowRange& table : map.tables)
      if (c.role == Role::reading && (c.way == Way::none) == (table.way == Way::none))
        return fail(of_option("columns",
                              "expected how the axis went, of each run (\"1 +\") or of "
                              "each of the tables (\"12-36 forward\"), found it " +
                                  std::string(c.way == Way::none ? "nowhere" : "twice") +
                                  " for run " + std::to_string(c.run)));
  if (map.means() && map.tables.size() > 1)
    return fail(of_option(
        "tables", "expected one table of means, found " + std::to_string(map.tables.size())));
  return {};
}

}  // namespace

bool Map::means() const {
  return std::any_of(columns.begin(), columns.end(),
                     [](const Column& c) { return c.role == Role::mean; });
}

Map Map::of(const RowRange& table) const {
  Map map = *this;
  map.tables = {table};
  for (Column& c : map.columns)
    if (c.role == Role::reading && c.way == Way::none) c.way = table.way;
  return map;
}

Expected<Map> map_of(const Settings& options, bool rotary) {
  Map map;
  auto columns = columns_of(options.texts("columns"));
  if (!columns) return fail(columns.error());
  auto table = table_map_of(options, rotary);
  if (!table) return fail(table.error());
  static_cast<TableMap&>(map) = std::move(*table);
  map.columns = std::move(*columns);
  if (map.positions && map.means())
    return fail(of_option("values", "expected deviations in a table of means, found positions"));
  if (auto ok = check_ways(map); !ok) return fail(ok.error());
  return map;
}

}  // namespace nonio::wide_table
