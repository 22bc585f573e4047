// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "nonio/controllers/axes.h"
#include "nonio/controllers/kit.h"
#include "nonio/controllers/replay.h"
#include "nonio/controllers/text.h"
#include "nonio/math/loaded_table.h"
#include "nonio/sdk/plugin.h"

namespace nonio::heidenhain_tnc {

namespace {

using controllers::KnownAxis;
using Lines = std::vector<std::string_view>;

// The word that begins in this column; the table editor uses only column positions.
std::string_view cell(std::string_view line, std::size_t column) {
  if (column == std::string_view::npos || column >= line.size()) return {};
  const std::string_view rest = line.substr(column);
  return rest.substr(0, std::min(rest.find(' '), rest.size()));
}

std::optional<double> real(std::string_view s) {
  if (s.empty() || (s[0] != '+' && s[0] != '-')) return {};  // a sign is mandatory
  return controllers::real(s);
}

std::size_t column_of(std::string_view head, std::string_view name) {
  for (std::size_t at = 0; (at = head.find(name, at)) != std::string_view::npos; ++at) {
    const bool begins = at == 0 || head[at - 1] == ' ';
    const bool ends = at + name.size() == head.size() || head[at + name.size()] == ' ';
    if (begins && ends) return at;
  }
  return std::string_view::npos;
}

std::optional<double> after(std::string_view line, std::string_view key) {
  const std::size_t at = line.find(key);
  return at == std::string_view::npos ? std::nullopt : real(cell(line, at + key.size()));
}

/// If line 1 has DATUM and DISTANCE, the rows must agree with them.
Expected<std::vector<double>> positions(const Lines& lines, std::size_t end) {
  const auto datum = after(lines[0], "DATUM:"), distance = after(lines[0], "DISTANCE:");
  if (datum.has_value() != distance.has_value() || (distance && !(*distance > 0.0)))
    return fail("no DATUM and DISTANCE in line 1");
  const std::size_t column = datum ? 8 : column_of(lines[1], "AXISPOS");
  std::vector<double> out;
  for (std::size_t i = 2; i < end; ++i) {
    const auto x = real(cell(lines[i], column));
    const double row = static_cast<double>(out.size());
    if (cell(lines[i], 0) != std::to_string(out.size()) || !x ||
        (datum && std::fabs(*x - (*datum + *distance * row)) > 1e-4))
      return fail("line " + std::to_string(i + 1) + " is not at its place");
    out.push_back(*x);
  }
  return out;
}

Expected<std::vector<double>> column(const Lines& lines, std::size_t end, std::string_view name) {
  std::vector<double> out;
  const std::size_t at = column_of(lines[1], name);
  for (std::size_t i = 2; i < end; ++i)
    if (const auto v = real(cell(lines[i], at))) out.push_back(*v);
  if (!out.empty() && out.size() != end - 2)
    return fail(std::string(name) + " is filled in some rows only");
  return out;
}

/// Entries are errors (+e), which the control subtracts.
LoadedTable table(const KnownAxis& input, const KnownAxis& output, const std::vector<double>& x,
                  const std::vector<double>& plus, const std::vector<double>& minus) {
  const bool turn = input.rotary && x.front() == 0.0 && x.back() == 360.0;
  LoadedTable t{.output = output.name,
                .input = {input.name},
                .position = {{}},
                .plus = {},
                .minus = {},
                .outside = turn ? LoadedTable::Outside::repeats : LoadedTable::Outside::holds,
                .rotary = output.rotary};
  for (const double v : x) t.position[0].push_back(v / input.per_si());
  for (const double v : plus) t.plus.push_back(0.0 - v / output.per_si());
  for (const double v : minus) t.minus.push_back(0.0 - v / output.per_si());
  return t;
}

using Owners = std::map<std::string, std::string, std::less<>>;

void note_owners(std::string_view cma, Owners& owners) {
  const Lines lines = controllers::lines_of(cma);
  if (lines.size() < 2) return;
  for (const std::string_view name : controllers::words_of(lines[1])) {
    if (name == "NR" || name == "ACTIVE") continue;
    for (std::size_t i = 2; i < lines.size(); ++i)
      if (const auto table = cell(lines[i], column_of(lines[1], name)); !table.empty())
        owners.emplace(table, name);
  }
}

Expected<std::vector<LoadedTable>> com(std::string_view bytes, const std::vector<KnownAxis>& axes,
                                       std::size_t most, const Owners& owners) {
  const Lines lines = controllers::lines_of(bytes);
  if (lines.size() < 4) return fail("not a .COM table");
  if (column_of(lines[0], "INCH") != std::string_view::npos)
    return fail("line 1 states INCH: " + std::string(lines[0].substr(0, 60)) +
                "; only tables in mm are read: save it from a control that is set to mm");
  const bool with_datum = lines[0].find("DATUM:") != std::string_view::npos;
  std::size_t end = lines.size();
  while (!with_datum && end > 2 && lines[end - 1] != "[END]") --end;
  if (!with_datum && --end < 3) return fail("no [END]");
  NONIO_TRY(const auto x, positions(lines, end));
  if (x.size() < 2 || x.size() > most)
    return fail(std::to_string(x.size()) + " rows, the control takes 2 to " + std::to_string(most));
  const auto name_of_table = cell(lines[0], 6);
  const auto owner = owners.find(name_of_table);
  const KnownAxis input = owner != owners.end()
                              ? axis_named(axes, owner->second)
                              : axis_of_file(axes, name_of_table, name_of_table.substr(0, 5));
  NONIO_TRY(const auto negative, column(lines, end, "BACKLASH"));
  std::vector<LoadedTable> tables;
  for (const auto name : controllers::words_of(lines[1])) {
    if (name == "NR" || name == "AXISPOS" || name == "BACKLASH") continue;
    NONIO_TRY(const auto values, column(lines, end, name));
    if (values.empty()) continue;
    const KnownAxis output = axis_named(axes, name);
    const bool own = output.name == input.name;
    tables.push_back(table(input, output, x, values, own ? negative : std::vector<double>{}));
    if (auto ok = math::validate_table(tables.back()); !ok)
      return tl::unexpected<Error>(ok.error());
  }
  return tables;
}

/// Follows the manual of the control, independently of the code that writes the files, so that it
/// verifies them.
Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  NONIO_TRY(const auto axes, controllers::known_axes(in));
  std::vector<LoadedTable> tables;
  std::map<std::string, double> backlash;
  const auto most = static_cast<std::size_t>(in.options.integer("max_points", 256));
  Owners owners;
  for (const Artifact& f : in.files)
    if (f.bytes.rfind("BEGIN CONFIG.CMA", 0) == 0) note_owners(f.bytes, owners);
  for (const Artifact& f : in.files) {
    if (auto ended = controllers::ends_whole(f.name, f.bytes); !ended)
      return tl::unexpected<Error>(ended.error());
    const Lines lines = controllers::lines_of(f.bytes);
    const bool is_table = !lines.empty() && lines[0].rfind("BEGIN ", 0) == 0;
    if (is_table && lines[0].rfind("BEGIN CONFIG.CMA", 0) == 0) continue;
    for (const std::string_view line : lines)
      if (const auto v = after(line, "backLash = "); v && !is_table)
        backlash[f.name.empty() ? "" : axis_of_file(axes, f.name, "heidenhain-tnc-").name] = *v;
    if (!is_table && in.files.size() == 1) return fail("not a .COM table");
    if (!is_table) continue;
    auto read = com(f.bytes, axes, most, owners);
    if (!read) return read;
    tables.insert(tables.end(), read->begin(), read->end());
  }
  for (LoadedTable& t : tables) {
    auto it = backlash.find(t.output);
    if (it == backlash.end()) it = backlash.find("");
    if (t.output == t.input.front() && it != backlash.end())
      t.backlash = it->second / (t.rotary ? deg_per_rad : 1e3);
  }
  return tables;
}

using controllers::lines_of;

bool is_table(const Artifact& a) {
  return a.bytes.rfind("BEGIN ", 0) == 0 && a.bytes.rfind("BEGIN CONFIG.CMA", 0) != 0;
}
bool is_assignment(const Artifact& a) { return a.bytes.rfind("BEGIN CONFIG.CMA", 0) == 0; }

std::string name_of(const Artifact& table) {
  const std::string_view rest = std::string_view(table.bytes).substr(6);
  return std::string(rest.substr(0, rest.find_first_of(" \r\n")));
}

struct Cell {
  std::size_t line = 0, column = 0, width = 0;
  std::string text{};
};

Expected<Cell> cell_of(const std::string& cma, const std::string& axis) {
  const auto lines = lines_of(cma);
  if (lines.size() < 3) return fail("CONFIG.CMA has no line");
  const auto headings = controllers::words_of(lines[1]);
  const auto heading = std::find(headings.begin(), headings.end(), axis);
  if (heading == headings.end()) return fail("CONFIG.CMA has no column " + axis);
  Cell cell;
  cell.column = static_cast<std::size_t>(heading->data() - lines[1].data());
  cell.width = heading + 1 == headings.end()
                   ? std::string::npos
                   : static_cast<std::size_t>((heading + 1)->data() - heading->data());
  std::vector<std::size_t> rows, active;
  for (std::size_t i = 2; i < lines.size(); ++i) {
    if (lines[i].empty() || lines[i].front() < '0' || lines[i].front() > '9') continue;
    rows.push_back(i);
    if (lines[i].find('*') != std::string_view::npos) active.push_back(i);
  }
  if (active.size() != 1 && rows.size() != 1)
    return fail("CONFIG.CMA: expected one active line (*), found " + std::to_string(active.size()));
  cell.line = active.size() == 1 ? active.front() : rows.front();
  const std::string_view line = lines[cell.line];
  if (cell.column < line.size())
    cell.text = controllers::trimmed(line.substr(cell.column, cell.width));
  return cell;
}

Expected<std::string> filled(const std::string& cma, const Cell& cell, const std::string& text) {
  if (text.size() >= cell.width) return fail("CONFIG.CMA has no room for " + text);
  std::size_t at = 0;
  for (std::size_t i = 0; i < cell.line; ++i) at = cma.find('\n', at) + 1;
  std::size_t end = std::min(cma.find('\n', at), cma.size());
  if (end > at && cma[end - 1] == '\r') --end;
  std::string line = cma.substr(at, end - at);
  if (line.size() < cell.column + text.size()) line.resize(cell.column + text.size(), ' ');
  line.replace(cell.column, text.size(), text);
  return cma.substr(0, at) + line + cma.substr(end);
}

/// Writes the .COM table under the name that CONFIG.CMA assigns to the axis, and fills an empty
/// cell of CONFIG.CMA.
Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  const auto fresh = std::find_if(in.table.begin(), in.table.end(), is_table);
  if (fresh == in.table.end()) return fail("no new table of axis " + in.axis);
  const auto cma = std::find_if(in.backup.begin(), in.backup.end(), is_assignment);
  if (cma == in.backup.end())
    return fail(
        "expected CONFIG.CMA among the files of the backup: it states which table is whose");
  NONIO_TRY(const auto cell, cell_of(cma->bytes, controllers::plain(in.axis)));
  const std::string name = cell.text.empty() ? name_of(*fresh) : cell.text;
  Artifact table = *fresh;
  table.bytes.replace(6, name_of(*fresh).size(), name);
  table.name = name;
  std::vector<Artifact> out;
  for (const Artifact& a : in.backup)
    if (is_table(a) && name_of(a) == name) {
      if (cell.text.empty())
        return fail("the backup has a table " + name + " that belongs to another axis");
      table.name = a.name;
    }
  out.push_back(std::move(table));
  if (cell.text.empty()) {
    NONIO_TRY(auto text, filled(cma->bytes, cell, name));
    out.push_back({cma->name, std::move(text)});
  }
  for (const Artifact& a : in.table)
    if (!is_table(a) && !is_assignment(a)) out.push_back(a);
  return out;
}

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
  NONIO_TRY(const auto jobs, controllers::write_axes(input, writer, result));
  std::vector<const AxisJob*> written;
  for (const AxisJob& job : jobs)
    if (job.loaded) written.push_back(&job);
  if (written.empty()) return result;
  for (const CrossJob& set : sets) predict_columns(set, jobs, input, result);
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
