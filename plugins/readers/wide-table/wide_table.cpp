// SPDX-License-Identifier: Apache-2.0
#include "wide_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "lines.h"
#include "nonio/sdk/column_map.h"
#include "nonio/sdk/format.h"
#include "runs.h"

namespace nonio::wide_table {
using namespace readers;

namespace {

struct Column {
  enum class Role : std::uint8_t { ignore, target, reading, mean, two_sigma, both, dead_zone };
  Role role = Role::ignore;
  Way way = Way::none;
  std::uint32_t run = 0;
};

using Role = Column::Role;

constexpr std::string_view channel_endings[] = {"_c", "_rpm", "_pct", "_kw", "_a"};

struct Map : TableMap {
  std::vector<Column> columns;

  bool means() const;
  /// The direction of a table applies to columns that state only a run.
  Map of(const RowRange& table) const;
};

const char* const roles_help =
    "\"target\", \"ignore\", a run and how it went (\"1 +\", \"1 -\", or \"1 forward\", \"1 "
    "reverse\": as the targets are listed; \"1\" where option tables states how it went), or of a "
    "print \"mean +\", \"mean -\", \"2s +\", \"2s "
    "-\" (or forward, reverse), \"mean\", \"dead zone\"";

/// Whether a text is the column of a recorded temperature, speed or load.
bool is_channel(std::string_view text) {
  return std::any_of(std::begin(channel_endings), std::end(channel_endings),
                     [&](std::string_view end) { return text.ends_with(end); });
}

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
  if (words.size() == 1 && is_channel(words[0]))
    return fail(of_option(
        "columns",
        "\"" + std::string(words[0]) +
            "\" has one value in a row, and the readings of the row were taken at different "
            "times: which value a reading had is not known. Give a table with a row for each "
            "reading (reader csv: run, direction, target_mm, deviation_um, time_s, " +
            std::string(words[0]) + "), or \"ignore\" the column"));
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
    NONIO_TRY(const auto column, column_of(text));
    if (column.role != Role::ignore && !seen.insert({column.role, column.way, column.run}).second)
      return fail(of_option("columns", "expected \"" + text + "\" once, found it twice"));
    readings = readings || column.role == Role::reading;
    means = means || column.role == Role::mean;
    columns.push_back(column);
  }
  if (!seen.contains({Role::target, Way::none, 0}))
    return fail(of_option("columns", "expected one \"target\", found none"));
  if (readings == means)
    return fail(of_option("columns",
                          readings ? "expected runs or means, found both; which of them count?"
                                   : "expected at least one run (\"1 +\") or mean (\"mean +\")"));
  return columns;
}

/// The direction of a run must be stated by either its column or its table.
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
  NONIO_TRY(auto columns, columns_of(options.texts("columns")));
  NONIO_TRY(auto table, table_map_of(options, rotary));
  static_cast<TableMap&>(map) = std::move(table);
  map.columns = std::move(columns);
  if (map.positions && map.means())
    return fail(of_option("values", "expected deviations in a table of means, found positions"));
  if (auto ok = check_ways(map); !ok) return fail(ok.error());
  return map;
}

/// In units of the file; NaN if missing.
struct Table {
  std::vector<std::vector<double>> rows;
  std::vector<std::uint64_t> lines;
  std::vector<double> targets;
  int decimals = 0;
};

int decimals_of(std::string_view number) {
  const std::size_t mark = std::min(number.find_first_of(".,"), number.size());
  return static_cast<int>(std::min<std::size_t>(number.size() - mark, 16)) - 1;
}

class TableReader {
 public:
  TableReader(const Map& map, Numbers& numbers) : map_(map), numbers_(numbers) {}

  Expected<Table> read(std::string_view bytes) {
    Lines lines(bytes);
    std::string_view line;
    while (lines.next(line)) {
      if (lines.number() < rows_.first) continue;
      if (rows_.last != 0 && lines.number() > rows_.last) break;
      if (content_of(line) != Content::fields) continue;
      if (auto error = not_text(line)) return fail(at_line(lines.number(), error->message));
      if (auto ok = row(line, lines.number()); !ok) return fail(ok.error());
    }
    if (table_.rows.size() < 2)
      return fail("expected two targets or more from line " + std::to_string(rows_.first) +
                  " on, found " + std::to_string(table_.rows.size()));
    return std::move(table_);
  }

 private:
  Expected<void> row(std::string_view line, std::uint64_t number) {
    const auto split = by_separator(line, map_.separator);
    if (!split || split->size() != map_.columns.size())
      return fail(at_line(number, "expected " + std::to_string(map_.columns.size()) +
                                      " fields as in option columns, found " +
                                      std::to_string(split ? split->size() : 0) + ": " +
                                      shown(line) +
                                      "; rows begin and end at first_line and "
                                      "last_line, or as option tables states"));
    const auto& fields = *split;
    std::vector<double> values;
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const Role role = map_.columns[k].role;
      if (role == Role::ignore) {
        values.push_back(0.0);
        continue;
      }
      const bool target = role == Role::target;
      const std::string what =
          (target ? "a target in column " : "a number in column ") + std::to_string(k + 1);
      NONIO_TRY(const auto value, target ? numbers_.number(fields[k], number, what)
                                         : numbers_.reading(fields[k], number, what));
      if (target) table_.targets.push_back(value);
      if (!target) table_.decimals = std::max(table_.decimals, decimals_of(fields[k]));
      values.push_back(value);
    }
    table_.rows.push_back(std::move(values));
    table_.lines.push_back(number);
    return {};
  }

  const Map& map_;
  const RowRange& rows_ = map_.tables.front();
  Numbers& numbers_;
  Table table_;
};

std::size_t column(const Map& map, Role role, int way, int listed) {
  for (std::size_t k = 0; k < map.columns.size(); ++k)
    if (const Column& c = map.columns[k];
        c.role == role && (way == 0 || direction_of(c.way, listed) == way))
      return k;
  return std::string::npos;
}

/// A column that is the mean of the other runs would reduce the scatter.
Expected<void> no_average(const Map& map, const Table& table, int listed) {
  if (table.rows.size() < 3) return {};
  for (std::size_t k = 0; k < map.columns.size(); ++k) {
    if (map.columns[k].role != Role::reading) continue;
    double largest = 0.0, size = 0.0;
    std::size_t others = 0;
    for (const auto& row : table.rows) {
      double sum = 0.0;
      others = 0;
      for (std::size_t j = 0; j < row.size(); ++j) {
        const bool same_way =
            map.columns[j].role == Role::reading && j != k &&
            direction_of(map.columns[j].way, listed) == direction_of(map.columns[k].way, listed);
        if (!same_way) continue;
        sum += row[j];
        ++others;
        size = std::max(size, std::fabs(row[j] - row[k]));
      }
      largest = std::max(largest, std::fabs(sum / static_cast<double>(others) - row[k]));
      if (std::isnan(sum) || std::isnan(row[k])) size = 0.0;
    }
    if (others >= 2 && size > 0.0 && largest <= 0.01 * size)
      return fail(of_option("columns", "column " + std::to_string(k + 1) +
                                           " is the mean of the other runs that go this way at "
                                           "every target; \"ignore\" it"));
  }
  return {};
}

Expected<void> check_print(const Map& map, const Table& table, int listed) {
  const std::size_t forward = column(map, Role::mean, listed, listed),
                    reverse = column(map, Role::mean, -listed, listed);
  if (forward == std::string::npos || reverse == std::string::npos) return {};
  const std::size_t both = column(map, Role::both, 0, listed),
                    dead = column(map, Role::dead_zone, 0, listed);
  const double rounding = 1.6 * std::pow(10.0, -table.decimals);  // rounding of three values
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    const double f = row[forward], r = row[reverse];
    if (both != std::string::npos && std::fabs(row[both] - 0.5 * (f + r)) > rounding)
      return fail(
          at_line(table.lines[i], "expected \"mean\" to be that of forward and reverse, found " +
                                      short_text(row[both], 6) + " of " + short_text(f, 6) +
                                      " and " + short_text(r, 6) + "; is the column map right?"));
    if (dead != std::string::npos && std::fabs(row[dead] - (r - f)) > rounding)
      return fail(
          at_line(table.lines[i],
                  "expected \"dead zone\" to be reverse - forward (the opposite sign of the "
                  "reversal of ISO 230-2), found " +
                      short_text(row[dead], 6) + " of " + short_text(r, 6) + " - " +
                      short_text(f, 6) + "; are the two columns swapped?"));
  }
  return {};
}

void note_means(const Map& map, const Table& table, bool rotary, Observations& obs) {
  double largest = 0.0;
  for (const auto& row : table.rows)
    for (std::size_t k = 0; k < row.size(); ++k)
      if (map.columns[k].role == Role::two_sigma && row[k] > largest) largest = row[k];
  obs.notes.push_back({"wide.means",
                       {{"largest", 0.5 * largest * std::fabs(map.factor) * map.value_unit,
                         deviation_of(rotary)}}});
}

Expected<void> add_rows(const Map& map, const Table& table, int listed, Runs& runs) {
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    for (std::size_t k = 0; k < map.columns.size(); ++k) {
      const Column& c = map.columns[k];
      if (c.role != Role::reading && c.role != Role::mean) continue;
      const double target = table.targets[i] * map.target_unit;
      const double deviation = map.deviation(table.rows[i][k], target);
      if (auto ok = runs.add({std::max(c.run, 1U), direction_of(c.way, listed), target, deviation,
                              table.lines[i]});
          !ok)
        return ok;
    }
  return {};
}

Expected<Observations> read_file(const ReadInput& input, const Axis& axis) {
  NONIO_TRY(const auto all, map_of(input.options, axis.rotary));
  Numbers numbers(all.separator != ',');
  Runs runs(input, axis, axis.rotary);
  int listed = 0;
  Table last;
  for (const RowRange& rows : all.tables) {
    const Map map = all.of(rows);
    NONIO_TRY(auto table, TableReader(map, numbers).read(input.bytes));
    const int sense = sense_of(table.targets);
    if (sense == 0)
      return fail(at_line(table.lines.front(), "expected targets that only rise or only fall"));
    if (listed == 0) listed = sense;
    if (auto ok = map.means() ? check_print(map, table, listed) : no_average(map, table, listed);
        !ok)
      return fail(ok.error());
    if (auto ok = add_rows(map, table, listed, runs); !ok) return fail(ok.error());
    last = std::move(table);
  }
  auto obs = runs.finish();
  if (obs && all.means()) note_means(all, last, axis.rotary, *obs);
  return obs;
}

}  // namespace

Reader reader() {
  Reader r;
  r.info = {
      "wide-table",
      "1.0",
      "Tables with a row for each target and a column for each run and direction, as the user maps "
      "them; only where the measurement names this reader.",
      {{"columns", std::vector<std::string>{}, "",
        "What each column is, in order: target, ignore, \"1 +\", \"1 -\", \"1 forward\", \"1\", "
        "\"mean +\", \"2s +\", mean, \"dead zone\"."}}};
  for (Option& option : table_map_options()) r.info.options.push_back(std::move(option));
  // A table of any form cannot be recognized.
  r.recognises = [](std::string_view) { return false; };
  r.reads = [](std::string_view kind) { return kind == "axis"; };
  r.read = [](const ReadInput& input) { return read_of_axis(input, read_file); };
  return r;
}

}  // namespace nonio::wide_table
