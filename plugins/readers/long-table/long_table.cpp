// SPDX-License-Identifier: Apache-2.0
#include "long_table.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <tuple>

#include "lines.h"
#include "nonio/sdk/column_map.h"
#include "nonio/sdk/format.h"
#include "runs.h"

namespace nonio::long_table {
using namespace readers;

namespace {

enum class Role : std::uint8_t {
  ignore,
  cycle,
  pos,
  target,
  direction,
  value,
  value_plus,
  value_minus
};
constexpr std::array<std::pair<const char*, Role>, 8> roles = {{{"ignore", Role::ignore},
                                                                {"cycle", Role::cycle},
                                                                {"pos", Role::pos},
                                                                {"target", Role::target},
                                                                {"direction", Role::direction},
                                                                {"value", Role::value},
                                                                {"value +", Role::value_plus},
                                                                {"value -", Role::value_minus}}};

struct Map : TableMap {
  std::vector<Role> columns;
  std::string heading;  ///< text before a target above the rows; empty with a target column
  bool has(Role role) const {
    return std::find(columns.begin(), columns.end(), role) != columns.end();
  }
};

Expected<std::vector<Role>> columns_of(const std::vector<std::string>& texts) {
  std::vector<Role> columns;
  for (const std::string& text : texts) {
    const auto role =
        std::find_if(roles.begin(), roles.end(), [&](const auto& r) { return text == r.first; });
    if (role == roles.end())
      return fail(
          of_option("columns",
                    "expected target, value, \"value +\", \"value -\", cycle (the run), pos "
                    "(number of the target), direction or ignore; found " +
                        shown(text)));
    const bool twice = std::find(columns.begin(), columns.end(), role->second) != columns.end();
    if (role->second != Role::ignore && twice)
      return fail(of_option("columns", "expected \"" + text + "\" once, found it twice"));
    columns.push_back(role->second);
  }
  return columns;
}

tl::unexpected<Error> needs_one(const char* name) {
  return fail(of_option("columns", std::string("expected one \"") + name +
                                       "\", found none. A table does not state what its columns "
                                       "are, and it is not guessed"));
}

Expected<Map> map_of(const Settings& options, bool rotary) {
  Map map;
  NONIO_TRY(auto columns, columns_of(options.texts("columns")));
  NONIO_TRY(auto table, table_map_of(options, rotary));
  static_cast<TableMap&>(map) = std::move(table);
  map.columns = std::move(columns);
  map.heading = options.text("heading");
  const bool both = map.has(Role::value_plus) || map.has(Role::value_minus);
  if (!map.has(Role::target) && map.heading.empty()) return needs_one("target");
  if (!map.has(Role::value) && !both) return needs_one("value");
  if (map.has(Role::target) && !map.heading.empty())
    return fail(
        of_option("heading", "expected the target in a column or in a heading, found both"));
  if (map.has(Role::value) && both)
    return fail(
        of_option("columns", "expected \"value\", or \"value +\" and \"value -\"; found both"));
  for (const RowRange& rows : map.tables) {
    const int stated =
        (rows.way != Way::none ? 1 : 0) + (map.has(Role::direction) ? 1 : 0) + (both ? 1 : 0);
    if (stated != 1)
      return fail(of_option("tables",
                            std::string("expected how the axis went, from a column \"direction\", "
                                        "from columns \"value +\" and \"value -\" or of each of "
                                        "the tables (\"12-36 forward\"), found it ") +
                                (stated == 0 ? "nowhere" : "twice")));
  }
  return map;
}

struct Row {
  std::uint32_t cycle = 0, pos = 0;
  Way way = Way::none;
  double target = 0.0, value = 0.0;
  std::uint64_t line = 0;
};

class TableReader {
 public:
  explicit TableReader(const Map& map) : map_(map), numbers_(map.separator != ',') {}

  Expected<std::vector<Row>> read(std::string_view bytes) {
    Lines lines(bytes);
    std::string_view line;
    std::size_t table = 0;
    while (table < map_.tables.size() && lines.next(line)) {
      const std::uint64_t number = lines.number();
      while (table < map_.tables.size() && map_.tables[table].last != 0 &&
             map_.tables[table].last < number)
        ++table;
      if (table == map_.tables.size()) break;
      if (take_heading(line)) continue;
      if (number < map_.tables[table].first || content_of(line) != Content::fields) continue;
      if (auto error = not_text(line)) return fail(at_line(number, error->message));
      if (table != table_) {
        table_ = table, visits_.clear();
        if (map_.heading.empty()) runs_before_ = runs_;
      }
      if (auto ok = row(line, number, map_.tables[table].way); !ok) return fail(ok.error());
    }
    return std::move(rows_);
  }

 private:
  Expected<void> row(std::string_view line, std::uint64_t number, Way way) {
    const auto fields = by_separator(line, map_.separator);
    if (!fields || fields->size() != map_.columns.size())
      return fail(at_line(number, "expected " + std::to_string(map_.columns.size()) +
                                      " fields as in option columns, found " +
                                      std::to_string(fields ? fields->size() : 0) + ": " +
                                      shown(line) +
                                      "; rows begin and end at first_line and "
                                      "last_line, or as option tables states"));
    Row row;
    row.way = way;
    row.line = number;
    if (!map_.heading.empty()) {
      if (!heading_target_)
        return fail(at_line(number, "expected a heading with " + shown(map_.heading) +
                                        " and the target above the rows, found none"));
      row.target = *heading_target_;
    }
    for (std::size_t k = 0; k < fields->size(); ++k)
      if (auto ok = field((*fields)[k], k, row); !ok) return ok;
    if (auto ok = same_target(row); !ok) return ok;
    if (map_.has(Role::value)) take(row);
    for (const auto& [role, of_role, value] : {std::tuple{Role::value_plus, Way::plus, plus_},
                                               std::tuple{Role::value_minus, Way::minus, minus_}}) {
      if (!map_.has(role)) continue;
      row.way = of_role, row.value = value;
      take(row);
    }
    return {};
  }

  /// Without a column `cycle`, each table is a new run of its direction, or several if it has
  /// repeated targets.
  void take(Row row) {
    if (!map_.has(Role::cycle)) {
      row.cycle = runs_before_[row.way] + ++visits_[{row.way, row.target}];
      runs_[row.way] = std::max(runs_[row.way], row.cycle);
    }
    rows_.push_back(row);
  }

  bool take_heading(std::string_view line) {
    const std::size_t at = map_.heading.empty() ? line.npos : line.find(map_.heading);
    if (at == line.npos) return false;
    const auto words = by_blanks(line.substr(at + map_.heading.size()));
    const Field target =
        words.empty() ? Field{} : parse_number(words.front(), map_.separator != ',');
    heading_target_ =
        target.kind == Field::Kind::taken ? std::optional(target.value) : std::nullopt;
    return true;
  }

  Expected<void> field(std::string_view text, std::size_t k, Row& row) {
    const auto in_column = [&](const char* what) {
      return std::string(what) + " in column " + std::to_string(k + 1);
    };
    const auto wrong = [&](const char* what) {
      return fail(at_line(row.line, "expected " + in_column(what) + ", found " + shown(text)));
    };
    const Role role = map_.columns[k];
    if (role == Role::cycle && (row.cycle = parse_run(text)) == 0)
      return wrong("a run, 1 or more,");
    if (role == Role::pos && (row.pos = parse_run(text)) == 0)
      return wrong("the number of a target, 1 or more,");
    if (role == Role::direction && (row.way = direction_of_word(text)) == Way::none)
      return wrong("+, -, forward or reverse");
    if (role != Role::target && role < Role::value) return {};
    const bool target = role == Role::target;
    NONIO_TRY(const auto number, target ? numbers_.number(text, row.line, in_column("a target"))
                                        : numbers_.reading(text, row.line, in_column("a number")));
    (target                      ? row.target
     : role == Role::value_plus  ? plus_
     : role == Role::value_minus ? minus_
                                 : row.value) = number;
    return {};
  }

  /// If one number has two targets, the column mapping is wrong.
  Expected<void> same_target(const Row& row) {
    if (row.pos == 0) return {};
    const auto [known, fresh] = by_pos_.try_emplace(row.pos, row);
    if (fresh || known->second.target == row.target) return {};
    std::string wanted, found;
    append_shortest(wanted, known->second.target);
    append_shortest(found, row.target);
    return fail(at_line(row.line, "expected target " + wanted + " at pos " +
                                      std::to_string(row.pos) + " as in line " +
                                      std::to_string(known->second.line) + ", found " + found));
  }

  const Map& map_;
  Numbers numbers_;
  std::map<std::uint32_t, Row> by_pos_;
  std::vector<Row> rows_;
  std::size_t table_ = 0;
  std::map<Way, std::uint32_t> runs_{}, runs_before_{};
  std::map<std::pair<Way, double>, std::uint32_t> visits_;
  std::optional<double> heading_target_{};
  double plus_ = 0.0, minus_ = 0.0;
};

int listed_in(const std::vector<Row>& rows) {
  const auto first =
      std::find_if(rows.begin(), rows.end(), [](const Row& r) { return r.way == Way::forward; });
  std::vector<double> targets;
  for (auto r = first; r != rows.end() && r->way == first->way && r->cycle == first->cycle; ++r)
    targets.push_back(r->target);
  return sense_of(targets);
}

Expected<Observations> read_file(const ReadInput& input, const Axis& axis) {
  NONIO_TRY(const auto map, map_of(input.options, axis.rotary));
  NONIO_TRY(const auto rows, TableReader(map).read(input.bytes));
  const int listed = listed_in(rows);
  Runs runs(input, axis, axis.rotary);
  for (const Row& row : rows) {
    if ((row.way == Way::forward || row.way == Way::reverse) && listed == 0)
      return fail(at_line(row.line,
                          "expected a first run \"forward\" whose targets only rise or only "
                          "fall, found none; state + and - in place of forward and reverse"));
    const double target = row.target * map.target_unit;
    if (auto ok = runs.add({row.cycle, direction_of(row.way, listed), target,
                            map.deviation(row.value, target), row.line});
        !ok)
      return fail(ok.error());
  }
  return runs.finish();
}

}  // namespace

Reader reader() {
  Reader r;
  r.info = {
      "long-table",
      "1.0",
      "Tables with a row for each reading, as the user maps their columns; only where the "
      "measurement names this reader.",
      {{"columns", std::vector<std::string>{}, "",
        "What each column is, in order: target, value, \"value +\", \"value -\", cycle, pos, "
        "direction, ignore."},
       {"heading", std::string(), "",
        "One table for each target: the words before the target in the line above a table."}}};
  for (Option& option : table_map_options()) r.info.options.push_back(std::move(option));
  // A table of any form cannot be recognized.
  r.recognises = [](std::string_view) { return false; };
  r.reads = [](std::string_view kind) { return kind == "axis"; };
  r.read = [](const ReadInput& input) { return read_of_axis(input, read_file); };
  return r;
}

}  // namespace nonio::long_table
