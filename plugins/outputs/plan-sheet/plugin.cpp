// SPDX-License-Identifier: Apache-2.0
// The plans of diagonals as a printed sheet: a table of triples, or plans with their stops.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>

#include "look.h"
#include "nonio/math/triples.h"
#include "nonio/reports/number.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/format.h"

namespace nonio::plan_sheet {
namespace {

using namespace reports;

constexpr double mm = 1e-3;

Expected<pages::Look> look_of(const Templates& templates, const std::string& name) {
  return pages::read_look(templates, name,
                          {"title", "identity", "status", "summary", "measurements", "notes",
                           "history", "laboratory", "models", "tables", "residuals"},
                          {"results", "plots", "findings", "targets", "budget"});
}

const PointTable* rows_of(const Results& results) {
  for (const Results::Analysed& a : results.analyses)
    if (const PointTable& rows = a.evaluation.rows;
        rows.column("a") != nullptr && rows.column("b") != nullptr && rows.column("c") != nullptr)
      return &rows;
  return nullptr;
}

struct Sheet {
  const OutputInput& in;
  const PointTable& rows;
  const Wording& words;
  const Axis *x, *y;
  math::MeasuringCost cost;

  std::size_t count() const { return rows.columns.front().values.size(); }
  bool planned() const { return rows.column("n") != nullptr; }
  double at(const char* name, std::size_t row) const {
    const PointTable::Column* c = rows.column(name);
    return c != nullptr && row < c->values.size() ? c->values[row] : 0.0;
  }
  std::string whole(const char* name, std::size_t row) const {
    return printed_number(at(name, row), Quantity::count, 0, words.language());
  }
  std::string number(double value, int decimals) const {
    return printed_number(value, Quantity::ratio, decimals, words.language());
  }
  std::string length(double si, int decimals) const {
    return printed_number(si, Quantity::length, decimals, words.language());
  }
  int decimals(std::initializer_list<const char*> names) const {
    std::vector<double> all;
    for (const char* name : names)
      for (std::size_t i = 0; i < count(); ++i) all.push_back(at(name, i));
    return decimals_for(all, Quantity::length, 4);
  }
  std::string triple(std::size_t row) const {
    return whole("a", row) + "-" + whole("b", row) + "-" + whole("c", row);
  }
  double minutes(std::size_t row) const {
    math::TriplePlan p;
    p.n = std::llround(at("n", row));
    p.length_x = at("length_x", row), p.length_y = at("length_y", row);
    p.length_d = at("length_d", row);
    return math::measuring_time(p, cost) / 60.0;
  }
};

using Cells = std::vector<Table::Cell>;

Block look_up(const Sheet& s) {
  constexpr std::size_t columns_per_row = 3;
  const std::size_t height = (s.count() + columns_per_row - 1) / columns_per_row;
  Columns columns;
  for (std::size_t part = 0; part < columns_per_row; ++part) {
    Table table;
    table.columns = {{"a", "", true}, {"b", "", true}, {"c", "", true}, {"b/a", "", true}};
    for (std::size_t i = part * height; i < std::min(s.count(), (part + 1) * height); ++i)
      table.rows.push_back({{s.whole("a", i)},
                            {s.whole("b", i)},
                            {s.whole("c", i)},
                            {s.number(s.at("b", i) / s.at("a", i), 3), true}});
    columns.parts.push_back({{std::move(table)}});
  }
  return {std::move(columns), "triples"};
}

Block plans(const Sheet& s) {
  const Wording& w = s.words;
  const std::string unit = unit_text(Quantity::length);
  Table table;
  table.title = w.get("sheet.plans");
  table.columns = {{"", "", true},
                   {"a-b-c", "", true},
                   {"b/a", "", true},
                   {"n", "", true},
                   {w.get("sheet.step_x"), unit, true},
                   {w.get("sheet.step_y"), unit, true},
                   {w.get("sheet.step_d"), unit, true},
                   {w.get("sheet.cover_x"), "%", true},
                   {w.get("sheet.cover_y"), "%", true},
                   {w.get("sheet.gain"), "", true},
                   {w.get("sheet.minutes"), "min", true}};
  const int x = s.decimals({"step_x"}), y = s.decimals({"step_y"}), d = s.decimals({"step_d"});
  for (std::size_t i = 0; i < s.count(); ++i) {
    math::TriplePlan p;
    p.length_x = s.at("length_x", i), p.length_y = s.at("length_y", i);
    p.length_d = s.at("length_d", i);
    table.rows.push_back({{std::to_string(i + 1)},
                          {s.triple(i), true},
                          {s.number(s.at("b", i) / s.at("a", i), 3)},
                          {s.whole("n", i)},
                          {s.length(s.at("step_x", i), x)},
                          {s.length(s.at("step_y", i), y)},
                          {s.length(s.at("step_d", i), d)},
                          {s.number(100.0 * s.at("cover_x", i), 2)},
                          {s.number(100.0 * s.at("cover_y", i), 2)},
                          {s.number(std::max(p.gain_EYX(), p.gain_EXY()), 2), false,
                           p.flat() ? Level::attention : Level::info},
                          {s.number(s.minutes(i), 0)}});
  }
  return {std::move(table), "plans"};
}

/// Lowest stop of an axis: start of the travel plus over-travel, m.
double start(const Sheet& s, const Axis& a) {
  return a.travel->first + s.in.options.number("over_travel_mm") * mm;
}

Table::Cell place(const Sheet& s, double si, int decimals) { return {s.length(si, decimals)}; }

void add_stops(const Sheet& s, std::size_t row, std::vector<Block>& blocks) {
  constexpr std::size_t columns_per_row = 2;
  const Wording& w = s.words;
  const auto n = static_cast<std::size_t>(std::llround(s.at("n", row)));
  const double step_x = s.at("step_x", row), step_y = s.at("step_y", row),
               step_d = s.at("step_d", row), x0 = start(s, *s.x), y0 = start(s, *s.y);
  const std::string field = "plan " + std::to_string(row + 1);
  blocks.push_back({Heading{w.get("sheet.stops_of",
                                  {{"number", std::to_string(row + 1)}, {"triple", s.triple(row)}}),
                            1},
                    field});
  blocks.push_back({Paragraph{w.get("sheet.stops_says", {{"n", std::to_string(n)},
                                                         {"stops", std::to_string(n + 1)},
                                                         {"x", s.x->name},
                                                         {"y", s.y->name}}),
                              Paragraph::Look::small, true},
                    field});
  std::vector<double> all{x0, y0};
  for (const double step : {step_x, step_y, step_d}) all.push_back(step);
  const int decimals = decimals_for(all, Quantity::length, 4);
  const std::string unit = unit_text(Quantity::length);
  const std::size_t height = (n + 1 + columns_per_row - 1) / columns_per_row;
  Columns columns;
  for (std::size_t part = 0; part < columns_per_row; ++part) {
    Table table;
    table.columns = {{"i", "", true},
                     {s.x->name, unit, true},
                     {s.y->name + ", D1", unit, true},
                     {s.y->name + ", D2", unit, true},
                     {"D", unit, true}};
    for (std::size_t i = part * height; i < std::min(n + 1, (part + 1) * height); ++i) {
      const auto k = static_cast<double>(i), rest = static_cast<double>(n - i);
      table.rows.push_back({{std::to_string(i)},
                            place(s, x0 + k * step_x, decimals),
                            place(s, y0 + k * step_y, decimals),
                            place(s, y0 + rest * step_y, decimals),
                            place(s, k * step_d, decimals)});
    }
    columns.parts.push_back({{std::move(table)}});
  }
  blocks.push_back({std::move(columns), field});
}

std::string travel_of(const Sheet& s, const Axis& a) {
  const auto [from, to] = *a.travel;
  const int decimals = decimals_for({from, to}, Quantity::length, 4);
  return s.length(from, decimals) + " … " + s.length(to, decimals) + " " +
         unit_text(Quantity::length);
}

void add_identity(const Sheet& s, std::vector<Block>& blocks) {
  const Wording& w = s.words;
  const Machine& m = s.in.campaign.machine;
  Grid grid;
  std::string name = m.maker;
  for (const std::string& part : {m.model, m.serial})
    if (!part.empty()) name += (name.empty() ? "" : " ") + part;
  grid.rows = {{w.get("identity.machine"), name, "machine"},
               {s.x->name, travel_of(s, *s.x), "machine.axes." + s.x->name},
               {s.y->name, travel_of(s, *s.y), "machine.axes." + s.y->name}};
  const double over = s.in.options.number("over_travel_mm");
  grid.rows.push_back({w.get("sheet.over_travel"),
                       s.length(over * mm, decimals_for({over * mm}, Quantity::length, 4)) + " " +
                           unit_text(Quantity::length),
                       "over_travel_mm"});
  blocks.push_back({std::move(grid), "identity"});
}

Document compose(const Sheet& s, const pages::Look& look) {
  const Wording& w = s.words;
  Document document;
  document.style = look.style;
  document.language = w.language();
  document.title = w.get(s.planned() ? "sheet.title_plans" : "sheet.title_table");
  document.head = document.title;
  document.foot = s.in.campaign.id;
  document.page_of = w.get("page_of");
  auto& blocks = document.blocks;
  blocks.push_back({Heading{document.title, 0}, "title"});
  if (!s.planned()) {
    blocks.push_back({Paragraph{w.get("sheet.table_says")}, "says"});
    blocks.push_back(look_up(s));
    blocks.push_back({Paragraph{w.get("sheet.table_how"), Paragraph::Look::small}, "how"});
    return document;
  }
  add_identity(s, blocks);
  blocks.push_back(plans(s));
  const auto& o = s.in.options;
  blocks.push_back(
      {Paragraph{w.get("sheet.plans_says", {{"runs", std::to_string(s.cost.runs)},
                                            {"feed", s.number(o.number("feed_mm_per_min"), 0)},
                                            {"dwell", s.number(o.number("dwell_s"), 1)}}),
                 Paragraph::Look::small},
       "says"});
  const auto wanted = static_cast<std::size_t>(o.integer("stops"));
  for (std::size_t i = 0; i < std::min(wanted, s.count()); ++i) add_stops(s, i, blocks);
  return document;
}

tl::unexpected<Error> wrong(std::string key, std::string message) {
  Error error{std::move(message)};
  error.key = std::move(key);
  return fail(std::move(error));
}

Expected<OutputResult> write(const OutputInput& in) {
  const Settings& o = in.options;
  const PointTable* rows = rows_of(in.results);
  if (rows == nullptr)
    return wrong("outputs", "plan-sheet: there is no plan (analysis triple-planner makes one)");
  const std::string language = o.text("language", "en");
  NONIO_TRY(const auto look, look_of(in.templates, o.text("template", "report")));
  NONIO_TRY(const auto fonts, pages::fonts_of(in.templates, look));
  const Wording words(in.templates, language, {"results", "report"});
  Sheet s{in,
          *rows,
          words,
          in.campaign.machine.axis(o.text("x")),
          in.campaign.machine.axis(o.text("y")),
          {o.integer("runs"), o.number("feed_mm_per_min") * mm / 60.0, o.number("dwell_s")}};
  if (s.planned())
    for (const auto& [axis, key] : {std::pair{s.x, "x"}, {s.y, "y"}})
      if (axis == nullptr || !axis->travel)
        return wrong("machine.axes",
                     "axis " + o.text(key) + ": expected a linear axis with its travel");
  const Document document = compose(s, look);
  if (const auto complete = words.complete(); !complete) return fail(complete.error());
  NONIO_TRY(auto bytes, pdf_bytes(document, *fonts));
  OutputResult result;
  result.artifacts.push_back(
      {language == "en" ? "plan-sheet.pdf" : "plan-sheet-" + language + ".pdf", std::move(bytes)});
  return result;
}

std::vector<Option> options() {
  return {
      one_of({"de", "en", "it"}, {"language", std::string("en"), "", "Language of the sheet."}),
      {"template", std::string("report"), "", "How it looks: templates/<name>.toml."},
      within(0.0, 1000.0, {"stops", std::int64_t{1}, "", "So many plans with their stops."}),
      {"x", std::string("X"), "", "First axis of the diagonals."},
      {"y", std::string("Y"), "", "Second axis of the diagonals."},
      within(0.0, 1e4, {"over_travel_mm", 1.0, "mm", "Kept free beyond the stops at both ends."}),
      within(1.0, 100.0, {"runs", std::int64_t{5}, "", "There and back, for the time."}),
      within(1.0, 1e6, {"feed_mm_per_min", 2000.0, "mm/min", "For the time."}),
      within(0.0, 3600.0, {"dwell_s", 5.0, "s", "At each stop, for the time."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.role = Output::Role::sheet_of_stops;
  output.info = {"plan-sheet", "1.0.0",
                 "Plans of diagonals with their stops, or the table of triples, as a PDF.",
                 options(), true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::plan_sheet
