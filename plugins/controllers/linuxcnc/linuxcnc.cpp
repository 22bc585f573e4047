// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "nonio/controllers/kit.h"
#include "nonio/sdk/format.h"

namespace nonio::linuxcnc {
namespace {

constexpr std::size_t most_entries = 256;

using controllers::AxisJob;
using controllers::Sheet;
using Confidence = ControlTable::Confidence;

ControlTable declared() {
  ControlTable t;
  t.name = "COMP_FILE";
  t.entry = ControlTable::Entry::position;
  t.grid = ControlTable::Grid::listed;
  t.position_step = t.value_step = {1e-11, 1e-8 / deg_per_rad};
  t.points = most_entries;
  t.bidirectional = true;
  t.facts = {{"sign", Confidence::run, "Type 0 holds actual positions, type 1 corrections."},
             {"grid", Confidence::run, "256 lines, linear between them, the ends hold outside."}};
  return t;
}

ControlTable corrections(ControlTable t) {
  t.entry = ControlTable::Entry::absolute;
  t.sign = ControlTable::Sign::correction;
  return t;
}

ControlTable table_of(const Settings& o) {
  ControlTable t = declared();
  if (o.text("units", "mm") == "inch") t.position_unit.linear = t.value_unit.linear = 25.4e-3;
  return o.integer("type") == 0 ? t : corrections(std::move(t));
}

// Contains only lines with three numbers, because the control stops reading at any other line.
std::string comp_file(const Sheet& s) {
  std::string out;
  for (std::size_t i = 0; i < s.position.size(); ++i) {
    for (const double v : {s.position[i], s.plus[i], s.minus[i]})
      out += (out.empty() || out.back() == '\n' ? "" : " ") + fixed_text(v / s.value_unit(), 8);
    out += "\n";
  }
  return out;
}

std::optional<std::string> joint_of(const AxisJob& job) {
  const auto joint = job.setting("joint"), number = job.setting("number");
  if (!joint && !number) return std::nullopt;
  return fixed_text(joint ? *joint : *number, 0);
}

/// If the joint is not stated, comments replace the section heading, so that lines are not inserted
/// into a wrong section.
std::string section_of(const AxisJob& job) {
  const auto joint = joint_of(job);
  if (joint) return "[JOINT_" + *joint + "]\n";
  const std::string axis = controllers::plain(job.axis);
  return "# the joint of " + axis +
         " is not stated: put these lines into its section; to have it\n" +
         "# here state joint = ... under [options.linuxcnc.axes." + axis +
         "], or number in the machine's record\n";
}

/// The number of lines, in a second file, serves to detect a truncated table.
std::string lines_said(const std::string& comp, const Sheet& s) {
  return comp + " has " + std::to_string(s.position.size()) + " lines";
}

std::string ini_snippet(const Sheet& s, const std::string& comp) {
  return controllers::comments(s.warning, "# ") + controllers::comments(s.job.about, "# ") +
         controllers::comments(s.zero_and_size(), "# ") + "# " + lines_said(comp, s) +
         "\n"
         "# BACKLASH has no effect with this table: the reversal is in its two columns\n" +
         section_of(s.job) + "COMP_FILE = " + comp +
         "\nCOMP_FILE_TYPE = " + std::to_string(s.input.options.integer("type")) + "\n";
}

std::string words(const Sheet& s, const std::string& comp) {
  const AxisJob& job = s.job;
  const bool inch = s.input.options.text("units") == "inch" && !job.rotary;
  std::vector<std::string> lines = s.warning;
  lines.insert(lines.end(), job.about.begin(), job.about.end());
  for (std::string& line : s.zero_and_size()) lines.push_back(std::move(line));
  lines.push_back(lines_said(comp, s));
  lines.push_back("file " + comp + ", joint " + joint_of(job).value_or("not stated") + ", in " +
                  (inch ? "inch" : std::string(job.unit())) +
                  ": nominal, moving towards plus, moving towards minus");
  lines.emplace_back(
      s.table.entry == ControlTable::Entry::position
          ? "COMP_FILE_TYPE = 0: columns 2 and 3 are the actual positions, nominal + deviation"
          : "COMP_FILE_TYPE = 1: columns 2 and 3 are added to the motor's position, the opposite "
            "of the deviation (actual - nominal)");
  lines.push_back(
      job.held ? controllers::reversal_words(job, controllers::Columns::both)
      : job.curve.bidirectional()
          ? "mean reversal B = " + controllers::deviation_words(job, job.mean_reversal()) +
                ": contained in the two columns; BACKLASH is ignored with a table"
          : "measured from one direction only: both columns have its deviation; "
            "BACKLASH is ignored with a table");
  lines.emplace_back(
      "do not put comments or blank lines into the file: the controller stops reading there "
      "without a message");
  lines.emplace_back(
      "the correction is fed in with half of the joint's velocity and acceleration: the drive "
      "needs headroom");
  if (job.rotary)
    lines.emplace_back("no wrap at 360 deg: outside of the table the end values hold");
  return controllers::comments(lines, "");
}

Expected<std::vector<Artifact>> files(const Sheet& s) {
  if (const double joint = s.job.setting("joint").value_or(s.job.setting("number").value_or(0.0));
      joint < 0.0 || joint > 15.0 || joint != std::floor(joint))
    return fail("option axes, axis " + s.job.axis + ": joint must be a whole number from 0 to 15");
  const std::string stem = "linuxcnc-" + s.job.stem, comp = stem + ".comp";
  return std::vector<Artifact>{
      {comp, comp_file(s)}, {stem + ".ini", ini_snippet(s, comp)}, {stem + ".txt", words(s, comp)}};
}

/// An error if lines were not read. The control silently stops at the first line that is not three
/// numbers, so a truncated file would not be detected.
Expected<void> whole(const Artifact& f, std::size_t taken, const std::vector<Artifact>& files) {
  const auto all = controllers::lines_of(f.bytes);
  std::size_t last = all.size();
  while (last > 0 && controllers::trimmed(all[last - 1]).empty()) --last;
  if (taken < last && taken == most_entries)
    return controllers::fail_at(f.name, taken + 1,
                                "the control refuses more than " + std::to_string(most_entries) +
                                    " entries (\"too many compensation entries\")");
  if (taken < last)
    return fail(f.name + ", line " + std::to_string(taken + 1) +
                ": expected three numbers, found \"" + std::string(all[taken].substr(0, 60)) +
                "\"; the control stops reading there without a message");
  if (f.bytes.back() != '\n') return fail(f.name + ": the last line has no end: the file was cut");
  const std::string key = f.name + " has ";
  for (const Artifact& a : files) {
    const std::size_t at = f.name.empty() ? std::string::npos : a.bytes.find(key);
    if (at == std::string::npos) continue;
    const auto said =
        controllers::words_of(std::string_view(a.bytes).substr(at + key.size(), 20), " \r\n");
    const auto n = controllers::whole(said.empty() ? "" : said.front());
    if (n && *n != static_cast<std::int64_t>(taken))
      return fail(f.name + ": " + std::to_string(taken) + " lines, " + a.name + " states " +
                  std::to_string(*n) + ": the file was cut");
  }
  return {};
}

/// Whether the entries rise with this slope from each end, within a tenth of the range. Actual
/// positions have slope 1, corrections slope 0; the file does not state its type.
bool follow(const controllers::RawTable& raw, double slope) {
  const auto& x = raw.position;
  const double tenth = 0.1 * (x.back() - x.front());
  for (const auto* entries : {&raw.plus, &raw.minus})
    for (std::size_t i = 0; i < x.size(); ++i)
      for (const std::size_t end : {std::size_t{0}, x.size() - 1})
        if (std::fabs((*entries)[i] - (*entries)[end] - slope * (x[i] - x[end])) > tenth)
          return false;
  return true;
}

Expected<void> check_type(const TableInput& in) {
  const std::int64_t type = in.options.integer("type");
  const std::string units = in.options.text("units", "mm");
  for (const Artifact& f : in.files)
    for (const std::string_view line : controllers::lines_of(f.bytes)) {
      const auto w = controllers::words_of(line, " \t\r=");
      if (w.size() == 2 && w[0] == "COMP_FILE_TYPE" && controllers::whole(w[1]) != type)
        return fail(f.name + " has COMP_FILE_TYPE = " + std::string(w[1]) + ", option type is " +
                    std::to_string(type) + ": state type = " + std::string(w[1]) +
                    " for the tables of this file");
      if (w.size() != 2 || w[0] != "LINEAR_UNITS") continue;
      const bool inch = w[1] == "inch" || w[1] == "in" || w[1] == "imperial";
      if (inch != (units == "inch"))
        return fail(f.name + " has LINEAR_UNITS = " + std::string(w[1]) + ", option units is " +
                    units + ": state units = \"" + (inch ? "inch" : "mm") +
                    "\" under [options.linuxcnc]");
    }
  return {};
}

// As in the source of the control: reading stops at the first line that is not three numbers, a
// line whose nominal position does not increase is dropped (an error here), and corrections are
// floats. The file name identifies the axis, unless the machine has only one.
Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  if (auto fits = check_type(in); !fits) return tl::unexpected<Error>(fits.error());
  NONIO_TRY(const auto axes, controllers::known_axes(in));
  const ControlTable t = table_of(in.options);
  std::vector<LoadedTable> tables;
  for (const Artifact& f : in.files) {
    controllers::RawTable raw{controllers::axis_of_file(axes, f.name, "linuxcnc-"), {}, {}};
    raw.backlash = 0.0;  // the control ignores BACKLASH with a table
    const double unit = t.value_unit.of(raw.axis.rotary);
    std::size_t taken = 0;
    for (const std::string_view line : controllers::lines_of(f.bytes)) {
      const auto words_of_line = controllers::words_of(line);
      if (line.size() > 254 || taken == most_entries || words_of_line.size() < 3) break;
      const auto x = controllers::real(words_of_line[0]),
                 plus = controllers::real(words_of_line[1]),
                 minus = controllers::real(words_of_line[2]);
      if (!x || !plus || !minus) break;
      ++taken;
      if (!raw.position.empty() && !(*x > raw.position.back()))
        return fail(f.name + ", line " + std::to_string(taken) + ": the nominal position " +
                    std::string(words_of_line[0]) +
                    " is not larger than that of the line before; the control ignores this line "
                    "without a message");
      raw.position.push_back(*x);
      raw.plus.push_back(*plus);
      raw.minus.push_back(*minus);
    }
    if (raw.position.empty()) continue;
    if (auto ok = whole(f, taken, in.files); !ok) return tl::unexpected<Error>(ok.error());
    const bool rises = follow(raw, 1.0), flat = follow(raw, 0.0);
    if (t.entry == ControlTable::Entry::absolute && rises && !flat)
      return controllers::fail_at(
          f.name, 1, "columns 2 and 3 are actual positions: state type = 0 (COMP_FILE_TYPE)");
    NONIO_TRY(auto read, controllers::loaded(flat && !rises ? corrections(t) : t, raw));
    for (auto* trims : {&read.plus, &read.minus})
      for (double& v : *trims) v = static_cast<double>(static_cast<float>(v / unit)) * unit;
    tables.push_back(std::move(read));
  }
  if (tables.empty()) return fail("no line is taken: there is no compensation");
  return tables;
}

Expected<OutputResult> write(const ControllerInput& input) {
  const controllers::Writer writer{.name = "linuxcnc",
                                   .table = table_of(input.options),
                                   .keys = {"joint:", "step", "first", "reference", "backlash"},
                                   .files = files,
                                   .parse = parse,
                                   .directions = controllers::Directions::always_without_backlash,
                                   .turn_end = controllers::TurnEnd::closed,
                                   .holds_documented = true};
  return controllers::write_tables(input, writer);
}

std::vector<Option> options() {
  ControlTable t = declared();
  t.bidirectional = false;  // always bidirectional, so there is no option for it
  t.points = 0;
  return controllers::table_options(
      t,
      "joint (or number; not stated, the INI lines name none), step_mm, first_mm, reference_mm "
      "(where the table is made zero), backlash_mm (BACKLASH while measured), and the same with "
      "_deg",
      {within(0.0, 1.0,
              {"type", std::int64_t{0}, "", "COMP_FILE_TYPE: 0 actual positions, 1 corrections."}),
       one_of({"mm", "inch"}, {"units", std::string("mm"), "", "LINEAR_UNITS of the machine."})});
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(controllers::controller(
      {"linuxcnc", "1.1.0", "Screw compensation files (COMP_FILE, types 0 and 1) for LinuxCNC.",
       options()},
      declared(), write, parse, controllers::Offered::always));
}

}  // namespace nonio::linuxcnc
