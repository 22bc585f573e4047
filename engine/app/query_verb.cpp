// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "laboratory/store/query.h"
#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"
#include "platform/storage/json_values.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
using store::NamedMachine;
using store::Point;
using store::Spelling;

namespace {

struct QueryWish {
  std::string out;
  store::Query query;
  bool csv = false;
};

struct QueryColumn {
  const char* name;
  std::string Point::*member;
  bool number = false;
};

constexpr auto query_columns = std::to_array<QueryColumn>({
    {"machine", &Point::machine},
    {"axis", &Point::axis},
    {"quantity", &Point::quantity},
    {"source", &Point::source},
    {"day", &Point::day},
    {"state", &Point::state},
    {"value", &Point::value, true},
    {"unit", &Point::unit},
    {"u_repeat", &Point::u_repeat, true},
    {"u_common", &Point::u_common, true},
    {"U", &Point::expanded, true},
    {"k", &Point::k, true},
    {"tolerance", &Point::tolerance, true},
    {"decision", &Point::decision},
    {"campaign", &Point::campaign},
    {"measurement", &Point::measurement},
    {"purpose", &Point::purpose},
    {"instrument", &Point::instrument},
    {"instrument_certificate", &Point::instrument_certificate},
    {"evaluation", &Point::evaluation, true},
    {"superseded_by", &Point::superseded_by, true},
});

void print_csv(const std::vector<Point>& points) {
  for (std::size_t i = 0; i < query_columns.size(); ++i)
    std::cout << (i == 0 ? "" : ",") << query_columns[i].name;
  std::cout << "\n";
  for (const Point& p : points) {
    for (std::size_t i = 0; i < query_columns.size(); ++i)
      std::cout << (i == 0 ? "" : ",")
                << (query_columns[i].number ? p.*query_columns[i].member
                                            : csv_text(p.*query_columns[i].member));
    std::cout << "\n";
  }
}

Json to_json(const Point& p) {
  Json json = Json::object();
  for (const QueryColumn& c : query_columns) {
    const std::string& text = p.*c.member;
    if (text.empty()) continue;
    if (c.number)
      json[c.name] = storage::parse(text);
    else
      json[c.name] = text;
  }
  if (!p.conditions.empty()) json["conditions"] = storage::parse_or_discard(p.conditions);
  return json;
}

Json to_json(const std::vector<Spelling>& spellings) {
  Json all = Json::array();
  for (const Spelling& s : spellings)
    all.push_back({{"one", s.one}, {"other", s.other}, {"why", s.why}});
  return all;
}

void print_rows(const std::vector<std::vector<std::string>>& rows, const std::string& right) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i)
      widths[i] = std::max(widths[i], columns_of(row[i]));
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += (i == 0 ? "" : "  ") +
              (right[i] == 'r' ? padded_left(row[i], widths[i]) : padded(row[i], widths[i]));
    }
    line.erase(line.find_last_not_of(' ') + 1);
    std::cout << line << "\n";
  }
}

std::pair<std::string, std::string> shown_result(const Point& p, const config::TerminalWords& say) {
  const double value = std::strtod(p.value.c_str(), nullptr);
  const double U = std::strtod(p.expanded.c_str(), nullptr);
  if (const auto rounded = rounded_result(value, U); U > 0.0 && rounded)
    return {say.number(rounded->value), say.number(rounded->U)};
  return {say.number(short_text(value)), ""};
}

/// Returns U = 2 u_repeat for the comparison of campaigns, rounded to two significant digits; empty
/// unless the source is "followed".
std::string shown_comparison(const Point& p) {
  const double u = std::strtod(p.u_repeat.c_str(), nullptr);
  const auto rounded = rounded_result(0.0, 2.0 * u);
  return p.source == "followed" && u > 0.0 && rounded ? rounded->U : "";
}

void print_table(const std::vector<Point>& points, const config::TerminalWords& say) {
  std::vector<std::vector<std::string>> rows{
      {say("list.machine"), say("head.axis"), say("list.quantity"), say("list.day"),
       say("list.state"), say("value"), "U", say("unit"), say("list.U"), say("list.campaign")}};
  for (const Point& p : points) {
    const auto [value, U] = shown_result(p, say);
    const std::string state =
        nonio::words(say.templates(), say.language(), "site.state." + p.state);
    rows.push_back(
        {p.machine, p.axis, p.quantity, p.day, state.empty() ? p.state : state, value, U, p.unit,
         say.number(shown_comparison(p)),
         p.campaign + (p.superseded_by.empty() ? "" : " (" + say("list.superseded") + ")")});
    for (std::string& cell : rows.back()) cell = printable(cell);
  }
  print_rows(rows, "lllllrrlrl");
}

int print_machines(const QueryWish& wish, const Common& common) {
  const auto machines = store::machines_in(wish.out);
  if (!machines) return complain(machines.error().message);
  const auto spellings = store::spellings_in(wish.out);
  if (!spellings) return complain(spellings.error().message);
  if (common.json) {
    Json all = Json::array();
    for (const NamedMachine& m : *machines)
      all.push_back({{"machine", m.name}, {"campaigns", m.campaigns}});
    print_json(Json{{"schema", "nonio-query/1"},
                    {"machines", std::move(all)},
                    {"spellings", to_json(*spellings)}});
    return exit_done;
  }
  const SiteWords words(common, language_at(wish.out));
  const config::TerminalWords& say = words.get();
  std::vector<std::vector<std::string>> rows{{say("list.machine"), say("list.campaigns")}};
  for (const NamedMachine& m : *machines)
    rows.push_back({m.name.empty() ? "(" + say("list.unnamed") + ")" : printable(m.name),
                    std::to_string(m.campaigns)});
  print_rows(rows, "lr");
  for (const Spelling& s : *spellings) {
    const Finding alike{
        .id = "worklist.spelling",
        .texts = {{"one", printable(s.one)}, {"other", printable(s.other)}, {"alike", s.key()}}};
    std::cout << wrapped(finding_text(say.templates(), say.language(), alike, "says") + " " +
                             finding_text(say.templates(), say.language(), alike, "advice"),
                         0, sentence_width(STDOUT_FILENO), 2);
  }
  return exit_done;
}

int query(const QueryWish& wish, const Common& common) {
  const store::Query& q = wish.query;
  if (q.machine.empty() && q.axis.empty() && q.quantity.empty() && q.source.empty() &&
      q.from.empty() && q.to.empty() && !wish.csv)
    return print_machines(wish, common);
  const auto points = store::query(wish.out, q);
  if (!points) return complain(points.error().message);
  if (common.json) {
    Json all = Json::array();
    for (const Point& p : *points) all.push_back(to_json(p));
    print_json(Json{{"schema", "nonio-query/1"}, {"points", std::move(all)}});
  } else if (wish.csv) {
    print_csv(*points);
  } else if (points->empty()) {
    if (!common.quiet)
      std::cout << SiteWords(common, language_at(wish.out)).get()("list.none") << "\n";
  } else {
    print_table(*points, SiteWords(common, language_at(wish.out)).get());
  }
  return exit_done;
}

}  // namespace

Verb machine_list_verb(Common& common) {
  auto wish = std::make_shared<QueryWish>();
  store::Query& q = wish->query;
  return {
      .name = "list",
      .summary = "Results of all campaigns of a machine, from the history of an output folder",
      .arguments = joined(
          {required(existing(Argument::Takes::folder,
                             {"OUT", &wish->out, "Output folder of `nonio run`"})),
           {"MACHINE", &q.machine,
            "Its asset, or maker and serial with a space between them; default: all machines"},
           {"--axis", &q.axis, "As the control names it: X, or X1 and X2 of a gantry"},
           {"--quantity", &q.quantity, "scale, B_mean, ln_s, A, R, ... as in results.json"},
           {"--source", &q.source,
            "\"followed\" (with covariance, for trends), or an analysis: iso230-2"},
           day({"--from", &q.from, "First day of the campaigns, YYYY-MM-DD"}),
           day({"--to", &q.to, "Last day, YYYY-MM-DD"}),
           {"--superseded", &q.superseded,
            "Include results that were replaced: other readings, other options, another version"},
           {"--csv", &wish->csv, "Comma-separated, all columns, for a spreadsheet"}},
          common_arguments(common)),
      .footer =
          "With OUT alone: lists the machines, and names that may be one machine. u is the "
          "standard uncertainty of the contributions that are new in each campaign, U the "
          "expanded one (k = 2); the contributions that campaigns share (the instrument, the "
          "expansion) are u_common in --csv and --json. The values are those of results.json, "
          "digit for digit. The history is OUT/history.sqlite, or a schema on the PostgreSQL "
          "server of [database] in site.toml; any tool for them reads it: tables `evaluation`, "
          "`result`, ..., view `point`.",
      .examples = {"nonio machine list out S-0042 --axis X --quantity B_mean --csv"},
      .run = [wish, &common] { return query(*wish, common); }};
}

}  // namespace nonio::app
