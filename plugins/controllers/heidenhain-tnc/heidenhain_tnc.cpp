// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "merge.h"
#include "nonio/controllers/kit.h"
#include "nonio/controllers/replay.h"
#include "parse.h"

namespace nonio::heidenhain_tnc {
namespace {

using controllers::AxisJob;
using controllers::CrossCurve;
using controllers::CrossJob;
using controllers::Sheet;
using controllers::signed_decimal;
using Confidence = ControlTable::Confidence;
using Crosses = std::vector<const CrossCurve*>;

ControlTable declared() {
  ControlTable t;
  t.name = ".COM, .CMA";
  t.grid = ControlTable::Grid::listed;
  t.position_step = {1e-4 / 1e3, 1e-4 / deg_per_rad};
  t.value_step = {1e-7, 1e-4 / deg_per_rad};
  t.points = 256;
  t.bidirectional = t.straightness = t.squareness = true;
  t.backlash = "CfgAxisComp/backLash (401802), MP710 or MP750";
  t.facts = {{"form", Confidence::inferred,
              "Inferred: sign +e of the .COM entries, their columns and 4 decimals (no file of the "
              "maker was seen)."},
             {"negative", Confidence::inferred,
              "Inferred: BACKLASH holds the deviation measured in the negative direction itself, "
              "not its difference."},
             {"cma", Confidence::inferred,
              "Inferred: layout of .CMA; which parameter takes the backlash value."}};
  return t;
}

struct Layout {
  bool listed, power_of_two;
  // First columns in the table editor, where a cell begins at the column of its heading.
  std::size_t position, negative, first_axis, width;
};

Layout layout_of(const Settings& options) {
  const std::string name = options.text("layout", "tnc640");
  return name == "tnc640" ? Layout{true, false, 5, 19, 33, 14}
                          : Layout{false, name == "tnc407", 8, 0, 20, 11};
}

void put(std::string& line, std::size_t column, const std::string& text) {
  if (line.size() < column) line.resize(column, ' ');
  line += text;
}

std::string com_name(const AxisJob& job, const Layout& layout) {
  return (layout.listed ? "AXIS_" : "AXIS-") + job.stem + ".COM";
}

std::vector<std::string> axis_columns(const Campaign& campaign, const AxisJob& job) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& axis) {
    const std::string name = controllers::plain(axis);
    if (!axis.empty() && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  };
  for (const Axis& a : campaign.machine.axes) add(a.name);
  for (const Axis& a : campaign.machine.axes) add(a.slave);
  add(job.axis);
  return names;
}

// A .COM file must not contain comments; these are in a second file.
std::string com_table(const Sheet& s, const std::vector<std::string>& axes, const Crosses& crosses,
                      const Layout& layout) {
  const auto place = [&](std::size_t i) { return s.position[i] / s.position_unit(); };
  const auto value = [&](double v) { return signed_decimal(v / s.value_unit(), 4); };
  std::string out = "BEGIN " + com_name(s.job, layout);
  out += layout.listed ? " MM\n"
                       : "  DATUM:" + signed_decimal(place(0), 4) +
                             " DISTANCE:" + signed_decimal(place(1) - place(0), 4) + "\n";
  std::string head = "NR";
  if (layout.listed) {
    put(head, layout.position, "AXISPOS");
    put(head, layout.negative, "BACKLASH");
  }
  const auto column = [&](const std::string& axis) {
    const auto at = std::find(axes.begin(), axes.end(), controllers::plain(axis));
    return layout.first_axis + layout.width * static_cast<std::size_t>(at - axes.begin());
  };
  for (const std::string& axis : axes) put(head, column(axis), axis);
  out += head + "\n";
  for (std::size_t i = 0; i < s.position.size(); ++i) {
    std::string line = std::to_string(i);
    put(line, layout.position, signed_decimal(place(i), 4));
    if (s.directions) put(line, layout.negative, value(s.minus[i]));
    std::map<std::size_t, double> cells{{column(s.job.axis), s.plus[i]}};
    for (const CrossCurve* c : crosses)
      cells[column(c->output)] = math::ErrorCurve::at(c->position, c->value, s.position[i]);
    for (const auto& [at, v] : cells) put(line, at, value(v));
    out += line + "\n";
  }
  return layout.listed ? out + "[END]\n" : out;
}

bool unfit_for_columns(const std::vector<std::string>& axes) {
  for (const std::string& a : axes)
    if (a.empty() || a.size() > 9 || a.find(' ') != std::string::npos) return true;
  return false;
}

std::vector<double> wanted(const AxisJob& job, const Crosses& crosses, const Layout& layout) {
  std::vector<double> at = job.table_curve().position;
  if (crosses.empty()) return at;
  if (!layout.listed) return crosses.front()->position;
  for (const CrossCurve* cross : crosses)
    at.insert(at.end(), cross->position.begin(), cross->position.end());
  std::sort(at.begin(), at.end());
  return at;
}

std::string words(const Sheet& s, const Crosses& crosses, const Layout& layout,
                  const std::string& artifact) {
  const AxisJob& job = s.job;
  std::vector<std::string> lines = s.warning;
  lines.insert(lines.end(), job.about.begin(), job.about.end());
  lines.push_back("file " + artifact + ": store it on the control as " + com_name(job, layout));
  lines.push_back(
      "sign: entries are the measured deviation (actual - nominal) with its own sign, "
      "in " +
      std::string(job.unit()));
  for (std::string& line : s.zero_and_size()) lines.push_back(std::move(line));
  for (const CrossCurve* c : crosses)
    lines.push_back("column " + controllers::cross_words(*c, s.value_step(), s.position));
  lines.push_back(controllers::reversal_words(job, s.columns()));
  if (job.curve.bidirectional()) {
    lines.emplace_back(layout.listed ? "CfgAxisComp/backLash (401802), positive where the encoder "
                                       "leads the table:"
                                     : "backlash machine parameter of the axis (MP710 or MP750), "
                                       "positive where the encoder leads the table:");
    lines.push_back("backLash = " + signed_decimal(s.backlash() * job.per_si(), 4));
  }
  lines.emplace_back(
      "The CONFIG.CMA of this output names the tables of the measured axes only: loaded in place "
      "of the "
      "control's own it takes the tables of all other axes away; let it into a backup with nonio "
      "table insert");
  lines.emplace_back("MP730 or the configuration must allow non-linear compensation for this axis");
  return controllers::comments(lines, "");
}

// One row per combination of tables. No row is active if an axis has two tables.
std::string cma_table(const std::vector<const AxisJob*>& written,
                      const std::vector<std::string>& axes, const Layout& layout) {
  const std::size_t active = 5, first = layout.listed ? 14 : 8;
  std::size_t width = 16, lines = 1;
  std::map<std::string, std::vector<std::string>> tables;
  for (const AxisJob* job : written) {
    auto& of_axis = tables[controllers::plain(job->axis)];
    of_axis.push_back(com_name(*job, layout));
    width = std::max(width, of_axis.back().size() + 2);
    lines = std::max(lines, of_axis.size());
  }
  std::string out = std::string("BEGIN CONFIG.CMA") + (layout.listed ? " MM" : "") + "\n";
  std::string head = "NR";
  if (layout.listed) put(head, active, "ACTIVE");
  for (std::size_t k = 0; k < axes.size(); ++k) put(head, first + width * k, axes[k]);
  out += head + "\n";
  for (std::size_t i = 0; i < lines; ++i) {
    std::string line = std::to_string(i);
    if (layout.listed && lines == 1) put(line, active, "*");
    for (std::size_t k = 0; k < axes.size(); ++k)
      if (const auto it = tables.find(axes[k]); it != tables.end())
        put(line, first + width * k, it->second[std::min(i, it->second.size() - 1)]);
    out += line + "\n";
  }
  return layout.listed ? out + "[END]\n" : out;
}

Crosses columns_of(const std::vector<CrossJob>& sets, const AxisJob& job,
                   const ControllerInput& input) {
  Crosses columns;
  std::size_t states = 0;
  for (const CrossJob& set : sets) {
    if (!controllers::together(set, job, input.campaign)) continue;
    ++states;
    for (const CrossCurve& curve : set.curves)
      if (curve.input == job.axis) columns.push_back(&curve);
  }
  return states == 1 ? columns : Crosses{};
}

void predict_columns(const CrossJob& set, const std::vector<AxisJob>& jobs,
                     const ControllerInput& input, OutputResult& result) {
  const controllers::Replay replay = controllers::replay_of(set, jobs, input);
  // A refused table also omits its columns; its finding states the reason.
  const bool any = std::any_of(set.curves.begin(), set.curves.end(), [&](const CrossCurve& curve) {
    return std::any_of(replay.tables.begin(), replay.tables.end(), [&](const LoadedTable& t) {
      return t.output == curve.output && t.input.front() == curve.input;
    });
  });
  if (!any) return;
  controllers::predict_lines(set, replay, result);
  controllers::note_cross(set, replay.tables, result);
  const char* note = set.volume ? "heidenhain.cross-volume" : "heidenhain.cross";
  if (std::none_of(result.notes.begin(), result.notes.end(),
                   [&](const Remark& r) { return r.id == note; }))
    result.notes.push_back({note});
}

Expected<std::vector<Artifact>> files(const Sheet& s, const Crosses& crosses,
                                      const Layout& layout) {
  const auto axes = axis_columns(s.input.campaign, s.job);
  if (unfit_for_columns(axes))
    return fail("axis " + s.job.axis +
                ": the table has columns for axis names of 1 to 9 characters without blanks");
  const std::string stem = "heidenhain-tnc-" + s.job.stem;
  return std::vector<Artifact>{{stem + ".COM", com_table(s, axes, crosses, layout)},
                               {stem + ".txt", words(s, crosses, layout, stem + ".COM")}};
}

ControlTable table_of(const Layout& layout, bool directions, const Settings& options) {
  ControlTable t = *controllers::chosen(declared(), options);
  if (!layout.listed) t.grid = ControlTable::Grid::even;
  std::erase_if(t.facts, [&](const ControlTable::Fact& f) {
    return (f.id == "negative" && !directions) || (f.id == "cma" && layout.listed);
  });
  return t;
}

Expected<OutputResult> write(const ControllerInput& input) {
  OutputResult result;
  const Layout layout = layout_of(input.options);
  const bool directions = input.options.flag("directions");
  if (directions && !layout.listed)
    return fail("layout " + input.options.text("layout") +
                " has no column for the negative direction: set layout = \"tnc640\" or "
                "directions = false");
  // Cross columns belong to one state of the machine and do not depend on direction.
  auto sets = directions
                  ? std::vector<CrossJob>{}
                  : controllers::cross_jobs(input, controllers::SecondSide::own_table, result);
  std::erase_if(sets, [&](const CrossJob& s) { return controllers::oversized(s, input, result); });
  const auto crosses = [&](const AxisJob& job) { return columns_of(sets, job, input); };
  const controllers::Writer writer{
      .name = "heidenhain-tnc",
      .table = table_of(layout, directions, input.options),
      .keys = {"step", "first", "reference", "backlash"},
      .files = [&](const Sheet& s) { return files(s, crosses(s.job), layout); },
      .parse = parse,
      .backlash_in_steps = true,
      .power_of_two = layout.power_of_two,
      .within_turn = layout.power_of_two,
      .wanted = [&](const AxisJob& job) { return wanted(job, crosses(job), layout); }};
  const auto jobs = controllers::write_axes(input, writer, result);
  if (!jobs) return tl::unexpected<Error>(jobs.error());
  std::vector<const AxisJob*> written;
  for (const AxisJob& job : *jobs)
    if (job.loaded) written.push_back(&job);
  if (written.empty()) return result;
  for (const CrossJob& set : sets) predict_columns(set, *jobs, input, result);
  result.artifacts.push_back(
      {"heidenhain-tnc-CONFIG.CMA",
       cma_table(written, axis_columns(input.campaign, *written.front()), layout)});
  result.notes.push_back({"heidenhain.cma-alone"});
  controllers::note_facts(writer, result);
  return result;
}

std::vector<Option> options() {
  return controllers::table_options(
      declared(),
      "step_mm, first_mm, reference_mm (where the table is made zero; else at 0), backlash_mm "
      "(the parameter while measured), and the same with _deg",
      {one_of({"tnc640", "itnc530", "tnc407"},
              {"layout", std::string("tnc640"), "",
               "Listed positions (tnc640), equidistant (itnc530), or that with a spacing of a "
               "power of two of 0.1 um (tnc407)."})});
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"heidenhain-tnc", "1.1.0",
       "Non-linear axis error tables (.COM, .CMA) and backlash for HEIDENHAIN TNC.", options()},
      declared(), write, parse, controllers::Offered::always);
  controller.merge = merge;
  registry.add(std::move(controller));
}

}  // namespace nonio::heidenhain_tnc
