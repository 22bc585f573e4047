// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <charconv>
#include <iostream>
#include <map>
#include <memory>

#include "axis_argument.h"
#include "campaign/planning/plan.h"
#include "campaign_verb.h"
#include "nonio/sdk/format.h"
#include "plan_sheet.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "site_words.h"
#include "tables.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

struct Lengths {
  std::string x, y, over_travel = "0", resolution = "1", resolution_x = "0", resolution_y = "0",
                    max_step = "0";
  std::vector<std::string> pitch_x, pitch_y;
};

struct Programs {
  std::string out, control;
  std::vector<std::string> settings;
};

struct Plan {
  Lengths mm;
  math::TripleRequest wish;
  std::string even = "any";
  std::int64_t count = 5, choose = 1;
  Programs programs;
  SheetWish sheet;
};

struct ProgramWish {
  std::vector<std::string> axes;
  std::string n, step_x, step_y, machine;
  Programs programs;
};

Expected<void> settle(Plan& plan) {
  math::TripleRequest& w = plan.wish;
  const auto one = [](const char* option, const std::string& text, double& to) -> Expected<void> {
    NONIO_TRY(const auto length, length_of(option, text));
    to = length;
    return {};
  };
  for (const auto& done : {one("--x", plan.mm.x, w.x), one("--y", plan.mm.y, w.y),
                           one("--over-travel", plan.mm.over_travel, w.over_travel),
                           one("--resolution", plan.mm.resolution, w.resolution),
                           one("--resolution-x", plan.mm.resolution_x, w.resolution_x),
                           one("--resolution-y", plan.mm.resolution_y, w.resolution_y),
                           one("--max-step", plan.mm.max_step, w.largest_step)})
    if (!done) return done;
  for (const auto& [option, texts, to] : {std::tuple{"--pitch-x", &plan.mm.pitch_x, &w.pitch_x},
                                          {"--pitch-y", &plan.mm.pitch_y, &w.pitch_y}})
    for (const std::string& text : *texts)
      if (const auto done = one(option, text, to->emplace_back()); !done) return done;
  w.even = plan.even == "require"  ? math::EvenSteps::require
           : plan.even == "prefer" ? math::EvenSteps::prefer
                                   : math::EvenSteps::any;
  if (plan.count < 1)
    return fail("--count: expected at least 1, found " + std::to_string(plan.count));
  w.count = static_cast<std::size_t>(plan.count);
  return {};
}

std::string mm_text(double m) { return evidence_text({"", m, Quantity::length}); }

std::vector<std::string> cells_of(std::size_t number, const math::TriplePlan& p,
                                  const std::string& language) {
  std::vector<std::string> cells{
      std::to_string(number),
      std::to_string(p.a) + "-" + std::to_string(p.b) + "-" + std::to_string(p.c),
      std::to_string(p.q), std::to_string(p.n)};
  for (const double m : {p.step_x, p.step_y, p.step_d, p.length_x, p.length_y, p.length_d})
    cells.push_back(localised(mm_text(m), language));
  for (const double x : {100.0 * p.cover_x, 100.0 * p.cover_y, p.gain_EYX(), p.gain_EXY()})
    cells.push_back(localised(fixed_text(x, 2), language));
  return cells;
}

void print_plans(const Plan& plan, const math::TriplePlans& found,
                 const config::TerminalWords& say) {
  constexpr std::size_t indent = 7;
  const std::size_t width = line_width(STDOUT_FILENO);
  const math::TripleRequest& w = plan.wish;
  const auto mm = [&](double m) { return localised(mm_text(m), say.language()); };
  std::cout << wrapped(say(w.largest_step > 0.0 ? "triples.wish-max-step" : "triples.wish",
                           {{"x", mm(w.x)},
                            {"y", mm(w.y)},
                            {"over_travel", mm(w.over_travel)},
                            {"resolution", mm(w.resolution)},
                            {"max_step", mm(w.largest_step)}}),
                       0, width)
            << "\n";
  const std::string step = say("triples.step") + " ";
  std::vector<std::vector<std::string>> cells{{"", "a-b-c", "q", "n", step + "X", step + "Y",
                                               step + "D", "X mm", "Y mm", "D mm", "X %", "Y %",
                                               "EYX", "EXY"}};
  for (std::size_t i = 0; i < found.plans.size(); ++i)
    cells.push_back(cells_of(i + 1, found.plans[i], say.language()));
  const std::vector<std::string> rows = table_rows(cells, width);
  std::cout << rows.front();
  for (std::size_t i = 0; i < found.plans.size(); ++i) {
    const math::TriplePlan& p = found.plans[i];
    std::cout << rows[i + 1]
              << wrapped(say("triples.why", {{"why", planning::why_listed(p, say)}}), indent, width,
                         2)
              << wrapped(say("triples.disadvantage",
                             {{"what", planning::gives_up(p, found.plans.front(), say)}}),
                         indent, width, 2);
    if (const std::string warning = planning::aspect_warning(p, say); !warning.empty())
      std::cout << wrapped(say("warning") + ": " + warning, indent, width, 2);
  }
  std::cout << "\n" << wrapped(say("triples.legend"), 0, width);
}

int write_programs(const Common& common, const Programs& p, const Machine& machine,
                   const PointTable& rows, std::map<std::string, std::string> settings,
                   std::vector<std::string>* written = nullptr) {
  if (p.control.empty() || p.out.empty())
    return complain("part programs: --control and a folder are required");
  const auto given = settings_of(p.settings);
  if (!given) return complain(given.error().message);
  for (const auto& [name, value] : *given) settings[name] = value;
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  for (const std::string& conflict : plugins.conflicts()) return complain(conflict);
  const auto files = planning::write_programs(plugins, p.control, machine, rows, settings);
  if (!files) {
    for (const Error& e : files.error()) complain(e.message);
    return exit_usage;
  }
  if (auto done = storage::publish(fs::absolute(p.out), *files); !done)
    return complain(done.error().message, exit_failed);
  for (const Artifact& a : *files) {
    const std::string path = (fs::path(p.out) / a.name).string();
    if (written != nullptr) written->push_back(path);
    if (!common.quiet) std::cerr << path << "\n";
  }
  return exit_done;
}

int plan_triples(Plan plan, const Common& common) {
  if (auto done = settle(plan); !done) return complain(done.error().message);
  const auto found = math::plan_triples(plan.wish);
  if (!found) return complain(found.error().message);
  const SiteWords words(common, common.json ? "en" : plan.sheet.language);
  if (common.json)
    std::cout << planning::triples_json(plan.wish, *found, words.get());
  else if (!found->plans.empty())
    print_plans(plan, *found, words.get());
  if (found->plans.empty())
    return complain(planning::why_nothing(*found, words.get()), exit_failed);
  const PointTable rows = math::triple_table(found->plans);
  const Machine machine = rectangle(plan.wish.x, plan.wish.y);
  if (!plan.sheet.file.empty())
    if (const int exit = write_sheet(plan.sheet, machine, rows,
                                     {{"over_travel_mm", plan.mm.over_travel}}, common);
        exit != exit_done)
      return exit;
  if (plan.programs.out.empty() && plan.programs.control.empty()) return exit_done;
  if (plan.choose < 1 || plan.choose > static_cast<std::int64_t>(found->plans.size()))
    return complain("--choose: expected 1 to " + std::to_string(found->plans.size()) + ", found " +
                    std::to_string(plan.choose));
  return write_programs(
      common, plan.programs, machine, rows,
      {{"plan", std::to_string(plan.choose)}, {"over_travel_mm", plan.mm.over_travel}});
}

Expected<PointTable> grid_of(const ProgramWish& p) {
  PointTable rows;
  if (p.n.empty() && p.step_x.empty() && p.step_y.empty()) return rows;
  std::int64_t n = 0;
  const char* const end = p.n.data() + p.n.size();
  const auto [stop, error] = std::from_chars(p.n.data(), end, n);
  if (error != std::errc() || stop != end || n < 1 || n > 100000)
    return fail("--n: expected a whole number of steps from 1 to 100000, found \"" + p.n + "\"");
  rows.columns.push_back({"n", Quantity::count, {static_cast<double>(n)}});
  for (const auto& [option, text, name] :
       {std::tuple{"--step-x", &p.step_x, "step_x"}, {"--step-y", &p.step_y, "step_y"}}) {
    NONIO_TRY(const auto step, length_of(option, *text));
    if (!(step > 0.0 && step < 1e3))
      return fail(std::string(option) + ": expected more than 0 mm, found \"" + *text + "\"");
    rows.columns.push_back({name, Quantity::length, {step}});
  }
  return rows;
}

int plan_program(const ProgramWish& p, const Common& common) {
  Machine machine;
  machine.model = p.machine;
  for (const std::string& text : p.axes) {
    const auto axis = axis_of(text);
    if (!axis) return complain(axis.error().message);
    if (machine.axis(axis->name) != nullptr)
      return complain("--axis: " + axis->name + " is given twice");
    machine.axes.push_back(*axis);
  }
  const auto rows = grid_of(p);
  if (!rows) return complain(rows.error().message);
  std::vector<std::string> files;
  const int exit = write_programs(common, p.programs, machine, *rows, {}, &files);
  if (common.json && exit == exit_done)
    print_json(storage::Json{{"schema", "nonio-programs/1"}, {"files", files}});
  return exit;
}

std::vector<Argument> program_arguments(Programs& p) {
  return {
      offering({"gcode", "siemens", "heidenhain"},
               {"--control", &p.control,
                "Writer of part programs: gcode, siemens, heidenhain or a plugin's whole name"}),
      settings_argument(p.settings,
                        "NAME=VALUE: an option of that writer (`nonio plugin list program-siemens` "
                        "lists them), such as "
                        "dwell_s=3, runs=2, programs=axes,diagonals; may be given several times")};
}

Verb triples_verb(Common& common) {
  auto plan = std::make_shared<Plan>();
  const std::string pitch =
      "Pitch of screw, rack or scale, mm: no step is a whole multiple of it; may be given several "
      "times";
  Argument even = one_of({"any", "prefer", "require"},
                         {"--even", &plan->even,
                          "An even number of steps, for a third diagonal to half of Y; "
                          "--even=prefer uses it if it costs at most 1 % of coverage"});
  even.bare = "require";
  return {
      .name = "triples",
      .summary = "Stops for X, Y and both diagonals of their rectangle, with equal whole steps",
      .arguments =
          joined({required(number({"--x", &plan->mm.x, "Travel of X, mm"})),
                  required(number({"--y", &plan->mm.y, "Travel of Y, mm"})),
                  number({"--over-travel", &plan->mm.over_travel,
                          "Range kept free at each end of both axes, mm (default 0)"}),
                  number({"--resolution", &plan->mm.resolution,
                          "Steps are whole multiples of this value, mm (default 1)"}),
                  number({"--resolution-x", &plan->mm.resolution_x,
                          "Scale factor of X: its steps are whole multiples of this, mm (default "
                          "--resolution)"}),
                  number({"--resolution-y", &plan->mm.resolution_y,
                          "The same of Y; --resolution is the diagonal's"}),
                  number({"--max-step", &plan->mm.max_step,
                          "Largest step of either axis, mm (default any)"}),
                  {"--max-points", &plan->wish.max_points,
                   "Entries of the control's compensation table (default 1500)"},
                  number({"--pitch-x", &plan->mm.pitch_x, pitch}),
                  number({"--pitch-y", &plan->mm.pitch_y, pitch}),
                  {"--density", &plan->wish.density,
                   "Only as many stops as ISO 230-2 requires: five per metre on axes of up to 2 m, "
                   "no more "
                   "than 250 mm apart on longer ones. They are evenly spaced, so they are no test "
                   "by ISO 230-2"},
                  even,
                  {"--hypotenuse", &plan->wish.hypotenuse,
                   "Largest c of the triples a-b-c (default 5000)"},
                  {"--count", &plan->count, "Plans to show (default 5)"},
                  takes(Argument::Takes::folder,
                        {"--program", &plan->programs.out,
                         "Folder for the part programs of one plan: X, Y and both diagonals"}),
                  {"--choose", &plan->choose, "Which plan --program writes (default 1)"}},
                 program_arguments(plan->programs),
                 joined(sheet_arguments(plan->sheet, common), common_arguments(common))),
      .footer =
          "A diagonal whose steps are whole needs a right triangle with whole sides: 3-4-5, "
          "5-12-13, ... Step = q (a, b, c) x resolution; n steps cover n q a of X and n q b of Y. "
          "The same n stops serve the pitch of X and Y, both straightnesses and the diagonals. The "
          "first plan has the best coverage of the worse axis. The others are listed with their "
          "advantage and their disadvantage.\n\nExit status: 0 plans were found; 1 no plan fits "
          "(prints which limits to relax); 2 usage.",
      .examples = {"nonio plan triples --x 12000 --y 9000 --max-step 500 --max-points 31"},
      .run = [plan, &common] { return plan_triples(*plan, common); }};
}

Verb program_verb(Common& common) {
  auto program = std::make_shared<ProgramWish>();
  return {
      .name = "program",
      .summary = "Part programs of axis runs, diagonals and step diagonals, without a campaign",
      .arguments = joined(
          {required(
               {"--axis", &program->axes,
                "NAME=FROM:TO, travel in mm, for A, B and C in deg; may be given several times"}),
           number({"--n", &program->n, "Steps of the diagonals (from `nonio plan triples`)"}),
           number({"--step-x", &program->step_x, "Step of X on the diagonals, mm"}),
           number({"--step-y", &program->step_y, "Step of Y on the diagonals, mm"}),
           {"--machine", &program->machine, "Name of the machine, for the comments"},
           required(takes(Argument::Takes::folder,
                          {"--out", &program->programs.out, "Folder for the programs"}))},
          program_arguments(program->programs), common_arguments(common)),
      .footer =
          "Axis runs have random offsets of the targets, as ISO 230-2 requires; the same seed "
          "(--set seed=7) gives the same targets. With --n, --step-x and --step-y the diagonals "
          "are written too, and X and Y have the same stops as the diagonals.",
      .examples = {"nonio plan program --axis X=0:800 --axis Y=0:600 --axis Z=0:600 --control "
                   "siemens --set programs=axes,step-diagonals --set steps=40 --out p"},
      .run = [program, &common] { return plan_program(*program, common); }};
}

}  // namespace

Verb plan_verb(Common& common) {
  return {.name = "plan",
          .summary = "Plans measurements: stops and part programs",
          .verbs = {triples_verb(common), program_verb(common), plan_rotary_verb(common),
                    plan_table_verb(common)}};
}

}  // namespace nonio::app
