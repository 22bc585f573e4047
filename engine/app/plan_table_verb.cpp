// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "axis_argument.h"
#include "campaign/planning/plan.h"
#include "campaign_verb.h"
#include "nonio/sdk/format.h"
#include "plan_sheet.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

struct TableWish {
  std::string x, y, resolution = "1", resolution_x = "0", resolution_y = "0", max_step = "0",
                    over_travel = "0", sort, out, control;
  bool cheapest = false;
  SheetWish sheet;
  std::int64_t hypotenuse = 299, runs = 5, max_points = 1500;
  double feed = 2000.0, dwell = 5.0, least_cover = 0.9;
  std::vector<std::string> settings;
  bool fits() const { return !x.empty() || !y.empty(); }
};

/// The plan is empty (n = 0) if no travels were given. It is not std::optional, because GCC 12
/// would give a false warning.
struct TableRow {
  math::Triple triple;
  math::TriplePlan plan{};
  double minutes = 0.0;
  bool fits() const { return plan.n > 0; }
  double ratio() const { return static_cast<double>(triple.b) / static_cast<double>(triple.a); }
};

math::MeasuringCost cost_of(const TableWish& w) { return {w.runs, w.feed / 60e3, w.dwell}; }

double minutes_of(const math::TriplePlan& p, const TableWish& w) {
  return math::measuring_time(p, cost_of(w)) / 60.0;
}

std::vector<std::string> cells_of(const TableRow& row, bool fits, const std::string& language) {
  std::vector<std::string> cells{std::to_string(row.triple.a), std::to_string(row.triple.b),
                                 std::to_string(row.triple.c),
                                 localised(fixed_text(row.ratio(), 3), language)};
  if (!fits) return cells;
  const math::TriplePlan& p = row.plan;
  const auto mm = [](double m) { return evidence_text({"", m, Quantity::length}); };
  for (std::string text : {std::to_string(p.q), std::to_string(p.n), mm(p.step_x), mm(p.step_y),
                           mm(p.step_d), fixed_text(100.0 * p.cover_x, 2),
                           fixed_text(100.0 * p.cover_y, 2), fixed_text(row.minutes, 1)})
    cells.push_back(row.fits() ? localised(std::move(text), language) : "");
  return cells;
}

void print_table_rows(const std::vector<TableRow>& rows, const TableWish& wish,
                      const config::TerminalWords& say) {
  const std::size_t width = line_width(STDOUT_FILENO);
  const std::string step = say("triples.step") + " ";
  std::vector<std::vector<std::string>> cells{{"a", "b", "c", "b/a"}};
  if (wish.fits())
    for (const std::string& head :
         {std::string("q"), std::string("n"), step + "X", step + "Y", step + "D",
          std::string("X %"), std::string("Y %"), say("triples.minutes")})
      cells.front().push_back(head);
  for (const TableRow& row : rows) cells.push_back(cells_of(row, wish.fits(), say.language()));
  for (const std::string& row : table_rows(cells, width)) std::cout << row;
  if (wish.fits())
    std::cout << "\n"
              << wrapped(say("triples.legend-cost",
                             {{"runs", std::to_string(wish.runs)},
                              {"feed", fixed_text(wish.feed, 0)},
                              {"dwell", localised(fixed_text(wish.dwell, 1), say.language())}}),
                         0, width);
}

Expected<std::vector<TableRow>> rows_that_fit(const TableWish& wish, math::TripleRequest& w,
                                              const config::TerminalWords& say) {
  for (const auto& [option, text, to] : {std::tuple{"--x", &wish.x, &w.x},
                                         {"--y", &wish.y, &w.y},
                                         {"--resolution", &wish.resolution, &w.resolution},
                                         {"--resolution-x", &wish.resolution_x, &w.resolution_x},
                                         {"--resolution-y", &wish.resolution_y, &w.resolution_y},
                                         {"--max-step", &wish.max_step, &w.largest_step},
                                         {"--over-travel", &wish.over_travel, &w.over_travel}}) {
    NONIO_TRY(const auto length, length_of(option, *text));
    *to = length;
  }
  w.hypotenuse = wish.hypotenuse;
  w.max_points = wish.max_points;
  w.count = 1000;
  std::vector<TableRow> rows;
  if (wish.cheapest) {
    NONIO_TRY(const auto plans, math::cheapest_plans(w, wish.least_cover, cost_of(wish)));
    for (const math::TriplePlan& p : plans)
      rows.push_back({{p.a, p.b, p.c}, p, minutes_of(p, wish)});
    if (!rows.empty()) return rows;
  }
  NONIO_TRY(const auto found, math::plan_triples(w));
  if (found.plans.empty()) return fail(planning::why_nothing(found, say));
  for (const math::TriplePlan& p : found.plans)
    if (p.worst_cover() >= wish.least_cover)
      rows.push_back({{p.a, p.b, p.c}, p, minutes_of(p, wish)});
  return rows;
}

storage::Json json_of(const TableRow& row) {
  storage::Json out{
      {"a", row.triple.a}, {"b", row.triple.b}, {"c", row.triple.c}, {"ratio", row.ratio()}};
  if (!row.fits()) return out;
  const math::TriplePlan& p = row.plan;
  out["q"] = p.q, out["n"] = p.n;
  out["step_x_mm"] = 1e3 * p.step_x, out["step_y_mm"] = 1e3 * p.step_y;
  out["step_d_mm"] = 1e3 * p.step_d;
  out["cover_x"] = p.cover_x, out["cover_y"] = p.cover_y;
  out["minutes"] = row.minutes;
  return out;
}

/// Each row gets a folder named by its number and its triple, for example 01-56-33-65. Returns the
/// exit status.
int write_row_programs(const std::vector<TableRow>& rows, const TableWish& wish,
                       const math::TripleRequest& w, const Common& common) {
  if (wish.control.empty()) return complain("part programs: --control is required");
  const auto given = settings_of(wish.settings);
  if (!given) return complain(given.error().message);
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  for (const std::string& conflict : plugins.conflicts()) return complain(conflict);
  const Machine machine = rectangle(w.x, w.y);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::map<std::string, std::string> settings{
        {"plan", "1"}, {"over_travel_mm", wish.over_travel}, {"runs", std::to_string(wish.runs)}};
    for (const auto& [name, value] : *given) settings[name] = value;
    const auto files = planning::write_programs(plugins, wish.control, machine,
                                                math::triple_table({rows[i].plan}), settings);
    if (!files) {
      for (const Error& e : files.error()) complain(e.message);
      return exit_usage;
    }
    const math::Triple& t = rows[i].triple;
    const std::string number = std::to_string(i + 1);
    const fs::path folder = fs::path(wish.out) / (std::string(number.size() < 2 ? "0" : "") +
                                                  number + "-" + std::to_string(t.a) + "-" +
                                                  std::to_string(t.b) + "-" + std::to_string(t.c));
    if (auto done = storage::publish(fs::absolute(folder), *files); !done)
      return complain(done.error().message, exit_failed);
    if (!common.quiet) std::cerr << folder.string() << ": " << files->size() << " files\n";
  }
  return exit_done;
}

PointTable sheet_rows(const std::vector<TableRow>& rows) {
  std::vector<math::TriplePlan> plans;
  for (const TableRow& row : rows) {
    plans.push_back(row.plan);
    plans.back().a = row.triple.a, plans.back().b = row.triple.b, plans.back().c = row.triple.c;
  }
  PointTable table = math::triple_table(plans);
  if (!rows.empty() && !rows.front().fits()) table.columns.resize(3);
  return table;
}

int plan_table(const TableWish& wish, const Common& common) {
  const SiteWords words(common, wish.sheet.language);
  math::TripleRequest request;
  std::vector<TableRow> rows;
  if (wish.x.empty() != wish.y.empty())
    return complain("--x and --y: expected both, or none for the table alone");
  if (!wish.out.empty() && !wish.fits()) return complain("--program: expected --x and --y too");
  if (wish.fits()) {
    auto found = rows_that_fit(wish, request, words.get());
    if (!found) return complain(found.error().message, exit_failed);
    rows = std::move(*found);
    if (rows.empty()) return complain(words.get()("triples.less-cover"), exit_failed);
  } else {
    for (const math::Triple& t : math::primitive_triples(wish.hypotenuse))
      rows.push_back({t, {}, 0.0});
  }
  const std::string sort = wish.sort.empty() ? (wish.fits() ? "minutes" : "ratio") : wish.sort;
  if (sort == "minutes" && !wish.fits())
    return complain("--sort=minutes: expected --x and --y too");
  std::stable_sort(rows.begin(), rows.end(), [&](const TableRow& one, const TableRow& other) {
    if (sort == "minutes") return one.minutes < other.minutes;
    if (sort == "ratio") return one.ratio() < other.ratio();
    return one.triple.c < other.triple.c;
  });
  if (common.json) {
    storage::Json out{{"schema", "nonio-triple-table/1"}, {"sort", sort}};
    out["rows"] = storage::Json::array();
    for (const TableRow& row : rows) out["rows"].push_back(json_of(row));
    print_json(out);
  } else {
    print_table_rows(rows, wish, words.get());
  }
  if (!wish.sheet.file.empty())
    if (const int exit = write_sheet(wish.sheet, rectangle(request.x, request.y), sheet_rows(rows),
                                     {{"over_travel_mm", wish.over_travel},
                                      {"runs", std::to_string(wish.runs)},
                                      {"feed_mm_per_min", fixed_text(wish.feed, 6)},
                                      {"dwell_s", fixed_text(wish.dwell, 6)}},
                                     common);
        exit != exit_done)
      return exit;
  return wish.out.empty() ? exit_done : write_row_programs(rows, wish, request, common);
}

}  // namespace

Verb plan_table_verb(Common& common) {
  auto wish = std::make_shared<TableWish>();
  return {
      .name = "table",
      .summary =
          "Look-up table of right triples by ratio; with travels, the plans that fit, by cost",
      .arguments = joined(
          {number({"--x", &wish->x, "Travel of X, mm"}),
           number({"--y", &wish->y, "Travel of Y, mm"}),
           within(
               5, 5000,
               {"--hypotenuse", &wish->hypotenuse, "Largest c of the triples a-b-c (default 299)"}),
           one_of(
               {"ratio", "c", "minutes"},
               {"--sort", &wish->sort, "Order of the rows (default ratio; with travels minutes)"}),
           number({"--resolution", &wish->resolution,
                   "Steps are whole multiples of this value, mm (default 1)"}),
           number({"--resolution-x", &wish->resolution_x,
                   "Scale factor of X: its steps are whole multiples of this, mm (default "
                   "--resolution)"}),
           number({"--resolution-y", &wish->resolution_y,
                   "The same of Y; --resolution is the diagonal's"}),
           number({"--max-step", &wish->max_step, "Largest step of either axis, mm (default any)"}),
           number({"--over-travel", &wish->over_travel,
                   "Range kept free at each end of both axes, mm (default 0)"}),
           {"--max-points", &wish->max_points,
            "Entries of the control's compensation table (default 1500)"},
           within(0.0, 1.0,
                  {"--least-cover", &wish->least_cover,
                   "Part of each axis that a plan must cover (default 0.9)"}),
           {"--cheapest", &wish->cheapest,
            "Of each triple the plan that takes least time (default: that covers most)"},
           within(1.0, 1e6, {"--feed", &wish->feed, "Feed, mm/min, for the cost (default 2000)"}),
           within(0.0, 1e4,
                  {"--dwell", &wish->dwell, "Dwell at a stop, s, for the cost (default 5)"}),
           within(1, 100, {"--runs", &wish->runs, "Runs there and back, for the cost (default 5)"}),
           takes(Argument::Takes::folder,
                 {"--program", &wish->out, "Folder for the part programs: a folder for each row"}),
           offering(
               {"gcode", "siemens", "heidenhain"},
               {"--control", &wish->control,
                "Writer of part programs: gcode, siemens, heidenhain or a plugin's whole name"}),
           settings_argument(wish->settings, "NAME=VALUE: an option of that writer")},
          joined(sheet_arguments(wish->sheet, common), common_arguments(common))),
      .footer =
          "Without travels: every primitive triple with a < b and c up to --hypotenuse, with b/a. "
          "With travels: the best plan of each triple, both ways round, and its cost in minutes. "
          "With separate resolutions, q is in units of their greatest common divisor.\n\nExit "
          "status: 0; 1 no plan fits (prints which limits to relax); 2 usage.",
      .examples = {"nonio plan table --x 20000 --y 12000 --max-step 500 --pdf plans.pdf"},
      .run = [wish, &common] { return plan_table(*wish, common); }};
}

}  // namespace nonio::app
