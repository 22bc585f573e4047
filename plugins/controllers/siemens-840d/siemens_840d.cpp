// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "nonio/controllers/kit.h"
#include "nonio/controllers/replay.h"
#include "nonio/controllers/text.h"
#include "nonio/sdk/plugin.h"
#include "parse.h"

namespace nonio::siemens_840d {

namespace {

/// Parts of a line such as "$AN_CEC_STEP[3]=50".
struct Line {
  std::string name;
  std::vector<std::string> index;
  std::string value;
};

std::optional<Line> line_of(std::string_view text) {
  text = controllers::trimmed(text.substr(0, text.find(';')));
  const std::size_t open = text.find('['), close = text.find(']'), equals = text.find('=');
  if (text.empty() || text.front() != '$' || close == std::string_view::npos ||
      equals == std::string_view::npos || !(open < close && close < equals))
    return std::nullopt;
  Line line{std::string(text.substr(1, open - 1)),
            {},
            std::string(controllers::trimmed(text.substr(equals + 1)))};
  for (const auto word : controllers::words_of(text.substr(open + 1, close - open - 1), ", \t"))
    line.index.emplace_back(word);
  return line;
}

using IsOwn = std::function<bool(const Line&)>;

bool is_comment(std::string_view line) { return controllers::trimmed(line).starts_with(';'); }

std::optional<std::string> replaced(const std::string& before, const IsOwn& is_own,
                                    const std::string& axis, const std::string& lines, bool add) {
  const std::string text =
      controllers::without_origin(before, ";", axis, [&](std::string_view one) {
        const auto line = line_of(one);
        return line && is_own(*line);
      });
  std::optional<std::size_t> end;
  for (const std::string_view one : controllers::lines_of(text))
    if (add && controllers::trimmed(one) == "M17")
      end = static_cast<std::size_t>(one.data() - text.data());
  return controllers::with_lines(
      text,
      [&](std::string_view one) {
        const auto line = line_of(one);
        return line && is_own(*line);
      },
      lines, end);
}

std::string body_of(const std::string& text) {
  std::string out;
  for (const std::string_view line : controllers::lines_of(text))
    if (line_of(line) || is_comment(line)) out += std::string(controllers::trimmed(line)) + "\n";
  return out;
}

std::vector<Line> lines_in(const std::vector<Artifact>& files) {
  std::vector<Line> out;
  for (const Artifact& f : files)
    for (const std::string_view text : controllers::lines_of(f.bytes))
      if (auto line = line_of(text)) out.push_back(std::move(*line));
  return out;
}

/// An axis with a name other than AXn could be the axis of the new table.
Expected<void> only_numbered(const std::vector<Artifact>& files) {
  const auto check = [](std::string_view axis) -> Expected<void> {
    const auto number =
        axis.starts_with("AX") ? controllers::whole(axis.substr(2)) : std::optional<std::int64_t>();
    if (number) return {};
    return fail("the backup calls an axis " + controllers::plain(axis) +
                ": expected AX1, AX2 and so on, which states whose table it is; save it so");
  };
  for (const Line& l : lines_in(files)) {
    const bool axis_last = l.name.rfind("AA_ENC_COMP", 0) == 0 || l.name == "MA_BACKLASH";
    if (axis_last && !l.index.empty())
      if (auto ok = check(l.index.back()); !ok) return ok;
    if ((l.name == "AN_CEC_INPUT_AXIS" || l.name == "AN_CEC_OUTPUT_AXIS") && l.value.size() > 2)
      if (auto ok = check(std::string_view(l.value).substr(1, l.value.size() - 2)); !ok) return ok;
  }
  return {};
}

struct Cec {
  std::string input, output, direction;
};

std::map<std::string, Cec> tables_in(const std::vector<Artifact>& files) {
  std::map<std::string, Cec> tables;
  const auto axis = [](const std::string& v) {
    return v.size() > 2 ? v.substr(1, v.size() - 2) : v;
  };
  for (const Line& l : lines_in(files)) {
    if (l.name.rfind("AN_CEC", 0) != 0 || l.index.empty()) continue;
    Cec& t = tables[l.index[0]];
    if (l.name == "AN_CEC_INPUT_AXIS") t.input = axis(l.value);
    if (l.name == "AN_CEC_OUTPUT_AXIS") t.output = axis(l.value);
    if (l.name == "AN_CEC_DIRECTION") t.direction = l.value;
  }
  return tables;
}

bool is_taken(std::int64_t number, const Settings& options) {
  const auto used = controllers::ranges_of(options.texts("taken"));
  return std::any_of(used.begin(), used.end(),
                     [&](const auto& r) { return r.first <= number && number <= r.second; });
}

Expected<std::map<std::string, std::string>> numbers_for(const std::map<std::string, Cec>& fresh,
                                                         const std::map<std::string, Cec>& present,
                                                         const Settings& options) {
  std::map<std::string, std::string> numbers;
  std::set<std::string> used;
  for (const auto& [number, t] : present) used.insert(number);
  for (const auto& [number, t] : fresh) {
    for (const auto& [old, p] : present)
      if (p.input == t.input && p.output == t.output && p.direction == t.direction) {
        if (numbers.contains(number))
          return fail("the backup has two tables of " + t.output + " in direction " + t.direction);
        numbers[number] = old;
      } else if (p.input == t.input && p.output == t.output && p.direction == "0") {
        return fail("table " + old + " of the backup compensates " + t.output +
                    " in both directions: take it out first");
      }
    for (std::int64_t k = 0; !numbers.contains(number) && k <= 127; ++k)
      if (!is_taken(k, options) && used.insert(std::to_string(k)).second)
        numbers[number] = std::to_string(k);
    if (!numbers.contains(number)) return fail("no number of a CEC table is free");
  }
  return numbers;
}

/// A comment "; table 3: ..." with the number that the table has in the backup.
std::string renumbered(const std::string& comment,
                       const std::map<std::string, std::string>& numbers) {
  const std::string start = "; table ";
  const std::size_t colon = comment.find(':');
  if (!comment.starts_with(start) || colon == std::string::npos) return comment;
  const auto to = numbers.find(comment.substr(start.size(), colon - start.size()));
  return to == numbers.end() ? comment : start + to->second + comment.substr(colon);
}

class Merger {
 public:
  explicit Merger(const MergeInput& in) : in_(in), files_(in.backup), changed_(in.backup.size()) {}

  Expected<void> take(const Artifact& table) {
    const std::string lines = body_of(table.bytes);
    const std::vector<Line> assignments = lines_in({table});
    if (assignments.empty()) return {};
    const Line* const first = &assignments.front();
    if (first->name.rfind("AN_CEC", 0) == 0) return take_directions(table);
    const bool backlash = first->name == "MA_BACKLASH";
    const std::string axis = first->index.back(), system = first->index.front();
    const auto own = [&](const Line& l) {
      return l.index.size() > 1 && l.index.front() == system && l.index.back() == axis &&
             (backlash ? l.name == "MA_BACKLASH" : l.name.rfind("AA_ENC_COMP", 0) == 0);
    };
    if (put(own, lines, backlash ? "MA_BACKLASH" : "AA_ENC_COMP")) return {};
    if (!backlash) return fail("the backup holds no $AA_ENC_COMP");
    added_.push_back(table);
    return {};
  }

  std::vector<Artifact> changed() const {
    std::vector<Artifact> out;
    for (std::size_t i = 0; i < files_.size(); ++i)
      if (changed_[i]) out.push_back(files_[i]);
    out.insert(out.end(), added_.begin(), added_.end());
    return out;
  }

 private:
  Expected<void> take_directions(const Artifact& table) {
    NONIO_TRY(const auto numbers, numbers_for(tables_in({table}), tables_in(files_), in_.options));
    std::string lines;
    std::set<std::string> own;
    for (const std::string_view text : controllers::lines_of(table.bytes))
      if (is_comment(text)) {
        if (text.find("CHOSEN, not read from a backup") == std::string_view::npos)
          lines += renumbered(std::string(controllers::trimmed(text)), numbers) + "\n";
      } else if (const auto l = line_of(text)) {
        const std::string& to = numbers.at(l->index[0]);
        own.insert(to);
        lines += "$" + l->name + "[" + to + (l->index.size() > 1 ? "," + l->index[1] : "") +
                 "]=" + l->value + "\n";
      }
    const auto is_own = [&](const Line& l) {
      return l.name.rfind("AN_CEC", 0) == 0 && !l.index.empty() && own.contains(l.index[0]);
    };
    if (put(is_own, lines, "AN_CEC")) return {};
    return fail("the backup holds no $AN_CEC: load the new file as it is");
  }

  bool put(const IsOwn& is_own, const std::string& lines, const std::string& kind) {
    for (const bool add : {false, true})
      for (std::size_t i = 0; i < files_.size(); ++i) {
        if (add && files_[i].bytes.find("$" + kind) == std::string::npos) continue;
        auto text = replaced(files_[i].bytes, is_own, in_.axis, lines, add);
        if (!text) continue;
        changed_[i] = *text != files_[i].bytes;
        files_[i].bytes = std::move(*text);
        return true;
      }
    return false;
  }

  const MergeInput& in_;
  std::vector<Artifact> files_, added_;
  std::vector<bool> changed_;
};

/// Replaces the lines of the axis in archives of several axes. Direction tables keep the numbers of
/// the backup, or get free ones.
Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  if (auto ok = only_numbered(in.backup); !ok) return fail(ok.error());
  Merger merger(in);
  for (const Artifact& table : in.table)
    if (auto done = merger.take(table); !done) return fail(done.error());
  return merger.changed();
}

using controllers::CrossCurve;
using controllers::CrossJob;
using controllers::decimal;

constexpr int digits = 6;
constexpr double per_si = 1e3;

/// Name of an axis in the control: (AX1), or "AX1" in newer editions.
struct Naming {
  std::vector<controllers::KnownAxis> axes;
  bool quoted;
  std::string operator()(const std::string& axis) const {
    const std::string ax = "AX" + std::to_string(controllers::axis_named(axes, axis).number);
    return quoted ? "\"" + ax + "\"" : "(" + ax + ")";
  }
};

/// Text that these table numbers were not read from the control.
std::string chosen_words(std::int64_t first, std::size_t count) {
  return "CHOSEN, not read from a backup: CEC tables " + std::to_string(first) + " to " +
         std::to_string(first + static_cast<std::int64_t>(count) - 1) +
         "; where the control has others there, load a file of nonio table insert instead";
}

std::string outputs(const CrossJob& job, const std::vector<controllers::KnownAxis>& axes) {
  std::string out;
  for (const std::string& axis : job.outputs())
    out += (out.empty() ? "" : ", ") + controllers::plain(axis) + " (AX" +
           std::to_string(controllers::axis_named(axes, axis).number) + ")";
  return out;
}

std::string table(const CrossCurve& curve, std::int64_t number, const Naming& name) {
  const std::string t = std::to_string(number);
  const auto line = [&](const char* what, const std::string& value) {
    return "$AN_CEC_" + std::string(what) + "[" + t + "]=" + value + "\n";
  };
  const auto& x = curve.position;
  const std::string side = curve.side_of.empty()
                               ? ""
                               : ", the second side of the gantry axis " +
                                     controllers::plain(curve.side_of) + ": the same entries";
  std::string out = "; table " + t + ": axis " + controllers::plain(curve.output) +
                    " by the position of " + controllers::plain(curve.input) + side + "\n; " +
                    controllers::cross_words(curve, 1e-9, x) + "\n";
  for (std::size_t i = 0; i < x.size(); ++i)
    out += "$AN_CEC[" + t + "," + std::to_string(i) +
           "]=" + decimal(curve.value[i] * per_si, digits) + "\n";
  const double step = (x.back() - x.front()) / static_cast<double>(x.size() - 1);
  return out + line("INPUT_AXIS", name(curve.input)) + line("OUTPUT_AXIS", name(curve.output)) +
         line("STEP", decimal(step * per_si, digits)) +
         line("MIN", decimal(x.front() * per_si, digits)) +
         line("MAX", decimal(x.back() * per_si, digits)) + line("IS_MODULO", "0") +
         line("DIRECTION", "0") + line("MULT_BY_TABLE", "0");
}

std::string file_text(const CrossJob& job, const ControllerInput& input, std::int64_t number,
                      const Naming& name) {
  std::size_t points = 0;
  for (const CrossCurve& curve : job.curves) points = std::max(points, curve.position.size());
  std::vector<std::string> words{
      std::string("straightness and squareness from the ") + (job.volume ? "step " : "") +
          "diagonals of " + controllers::plain(job.measurement) + ", campaign " +
          controllers::plain(input.campaign.id),
      job.volume ? "pitch itself is not in these tables"
                 : "the same points as the pitch tables; pitch itself is not in these tables",
      "entries are the error of the output axis with its own sign:",
      "a positive entry moves the output axis towards minus",
      "MD18342[t] >= " + std::to_string(points) + "; enable MD32710 of " + outputs(job, name.axes) +
          " and SD41300[t]",
      chosen_words(number, job.curves.size())};
  if (!job.slave_zero)
    words.insert(words.begin() + 2,
                 std::string("the squareness is in them: do not ") +
                     (job.volume ? "enter it elsewhere too"
                                 : "shift the zero of a gantry's second side too"));
  for (std::string& line : controllers::set_words(job)) words.push_back(std::move(line));
  std::string out = "%_N_NC_CEC_INI\nCHANDATA(1)\n" + controllers::comments(words, "; ");
  for (const CrossCurve& curve : job.curves) out += table(curve, number++, name);
  return out + "M17\n";
}

void note_enabling(const CrossJob& job, const std::vector<controllers::KnownAxis>& axes,
                   std::vector<Remark>& notes) {
  const Remark note{job.volume       ? "siemens.cross-volume"
                    : job.slave_zero ? "siemens.cross-straight"
                                     : "siemens.cross",
                    {},
                    {{"axes", outputs(job, axes)}}};
  if (notes.empty() || notes.back().id != note.id || notes.back().texts != note.texts)
    notes.push_back(note);
}

/// An error if one of these CEC tables is in use (option `taken`).
Expected<void> free_tables(std::int64_t first, std::size_t count, const Settings& options) {
  const std::int64_t last = first + static_cast<std::int64_t>(count) - 1;
  for (const auto& [low, high] : controllers::ranges_of(options.texts("taken")))
    if (low <= last && first <= high)
      return fail("CEC tables " + std::to_string(first) + " to " + std::to_string(last) +
                  " would meet those in use (" + std::to_string(low) + " to " +
                  std::to_string(high) + "): set first_cec_table, or use nonio table insert");
  return {};
}

/// Adds the text of `chosen_words` as a note.
void note_chosen(const std::string& axis, std::int64_t first, std::size_t count,
                 OutputResult& result) {
  const std::int64_t last = first + static_cast<std::int64_t>(count) - 1;
  result.notes.push_back(
      {"table.numbers-chosen",
       {},
       {{"axis", axis}, {"numbers", std::to_string(first) + "-" + std::to_string(last)}}});
}

/// Writes one CEC table per cross curve from diagonals or step diagonals (six for a volume); the
/// squareness is in one curve of each plane. `pitch`: pitch tables already written.
Expected<void> write_cross_tables(const ControllerInput& input,
                                  const std::vector<controllers::AxisJob>& pitch,
                                  OutputResult& result) {
  const Campaign campaign = controllers::with_axes_of(input, pitch);
  NONIO_TRY(const auto axes, controllers::known_axes({{}, campaign, input.options}));
  const Naming name{axes, input.options.flag("quoted_axes")};
  std::int64_t first = input.options.integer("first_cec_table");
  if (input.options.flag("directions")) {
    std::size_t most = input.campaign.machine.axes.size();
    for (const controllers::KnownAxis& axis : axes) most = std::max(most, axis.number);
    first += 2 * static_cast<std::int64_t>(most);
  }

  const auto jobs = controllers::cross_jobs(input, controllers::SecondSide::own_table, result);
  std::vector<Remark> enabling;
  for (const CrossJob& job : jobs) {
    if (auto ok = controllers::fits(job, input.options); !ok) return ok;
    if (controllers::lacks_number(job.moving(), input, axes, job.measurement, result)) continue;
    if (controllers::oversized(job, input, result)) continue;
    if (auto free = free_tables(first, job.curves.size(), input.options); !free)
      return fail("diagonals of " + job.measurement + ": " + free.error().message);
    const std::string stem = "siemens-840d-" + controllers::file_part(job.axes()) +
                             (jobs.size() > 1 ? "-" + controllers::file_part(job.measurement) : "");
    Artifact file{stem + "-CEC.ini", file_text(job, input, first, name)};
    if (auto done = controllers::predict_cross(job, {file}, parse, pitch, input, result); !done)
      return done;
    result.artifacts.push_back(std::move(file));
    note_chosen(job.axes(), first, job.curves.size(), result);
    note_enabling(job, axes, enabling);
  }
  result.notes.insert(result.notes.end(), enabling.begin(), enabling.end());
  return {};
}

using controllers::AxisJob;
using controllers::Sheet;
using Confidence = ControlTable::Confidence;

ControlTable declared() {
  ControlTable t;
  t.name = "$AA_ENC_COMP, $AN_CEC";
  t.zero = ControlTable::Zero::reference;
  t.position_step = {1e-4 / 1e3, 1e-3 / deg_per_rad};
  t.value_step = {1e-9, 1e-6 / deg_per_rad};  // no limit in practice: 1 nm, 0.004 arcsec
  t.points = 200;                             // 808D, 828D; others state MD38000 and MD18342
  t.bidirectional = t.straightness = t.squareness = true;
  t.backlash = "MD32450";
  t.facts = {{"sign", Confidence::documented, "A positive entry drives the axis towards minus."},
             {"form", Confidence::inferred,
              "Inferred: comment lines and the TEA block of the backlash file."},
             {"cec", Confidence::inferred,
              "Inferred: whether setpoint or actual value indexes a CEC table (editions of the "
              "manual contradict each other); form of the axis names (option quoted_axes)."}};
  return t;
}

std::string axis_name(const Sheet& s) { return "AX" + std::to_string(s.job.number); }

std::string remarks(const Sheet& s, const std::vector<std::string>& of_table) {
  return controllers::comments(s.warning, "; ") + controllers::comments(s.job.about, "; ") +
         controllers::comments(of_table, "; ");
}

const char* const sign_is =
    "entries are the measured deviation (actual - nominal) with its own sign:";
const char* const sign_does =
    "the control adds them to the actual position, a positive entry drives towards minus";

std::string range_lines(const std::string& variable, const std::string& index, const Sheet& s) {
  const auto line = [&](const char* name, const std::string& value) {
    return "$" + variable + "_" + name + "[" + index + "]=" + value + "\n";
  };
  const double mm = s.position_unit();
  return line("STEP", decimal(s.grid.step / mm, 6)) + line("MIN", decimal(s.grid.first / mm, 6)) +
         line("MAX", decimal(s.grid.last() / mm, 6)) + line("IS_MODULO", s.job.turn ? "1" : "0");
}

std::string encoder_table(const Sheet& s) {
  const std::string system = std::to_string(s.input.options.integer("measuring_system"));
  const std::string axis = axis_name(s);
  std::string out = "%_N_" + axis + "_EEC_INI\nCHANDATA(1)\n";
  out +=
      remarks(s, {sign_is, sign_does,
                  "zero at the reference position " + controllers::with_unit(s.job, s.reference, 4),
                  s.outside_words(), s.zero_and_size().back(),
                  controllers::reversal_words(s.job, controllers::Columns::mean),
                  "MD38000[" + system + "] >= " + std::to_string(s.grid.points) +
                      "; load with MD32700[" + system + "] = 0, then 1, power on, reference"});
  for (std::size_t i = 0; i < s.plus.size(); ++i)
    out += "$AA_ENC_COMP[" + system + "," + std::to_string(i) + "," + axis +
           "]=" + s.entry(s.plus[i]) + "\n";
  return out + range_lines("AA_ENC_COMP", system + "," + axis, s) + "M17\n";
}

std::string backlash_file(const Sheet& s) {
  return "%_N_" + axis_name(s) + "_TEA_INI\nCHANDATA(1)\n" +
         remarks(s, {controllers::reversal_words(s.job, controllers::Columns::mean),
                     "MD32450: positive where the encoder leads the machine part (lost motion)"}) +
         "$MA_BACKLASH[" + std::to_string(s.input.options.integer("measuring_system")) + "," +
         axis_name(s) + "]=" + decimal(s.backlash() * s.job.per_si(), 6) + "\nM17\n";
}

std::int64_t first_table(const Sheet& s) {
  return s.input.options.integer("first_cec_table") +
         2 * (static_cast<std::int64_t>(s.job.number) - 1);
}

// Direction-dependent pitch: input axis = output axis, one table for each direction of travel.
std::string direction_tables(const Sheet& s) {
  const bool quoted = s.input.options.flag("quoted_axes");
  const std::string axis = (quoted ? "\"" : "(") + axis_name(s) + (quoted ? "\"" : ")");
  std::string out = "%_N_NC_CEC_INI\nCHANDATA(1)\n";
  out += remarks(
      s, {sign_is, sign_does,
          "mean of both directions zero at " + controllers::with_unit(s.job, s.reference, 4),
          s.outside_words(), s.zero_and_size().back(),
          controllers::reversal_words(s.job, controllers::Columns::both),
          chosen_words(first_table(s), 2),
          "MD18342[t] >= " + std::to_string(s.grid.points) +
              "; enable MD32710 of the axis and SD41300[t]"});
  std::int64_t number = first_table(s);
  for (const int direction : {1, -1}) {
    const std::string t = std::to_string(number++);
    const auto& entries = direction > 0 ? s.plus : s.minus;
    for (std::size_t i = 0; i < entries.size(); ++i)
      out += "$AN_CEC[" + t + "," + std::to_string(i) + "]=" + s.entry(entries[i]) + "\n";
    out += "$AN_CEC_INPUT_AXIS[" + t + "]=" + axis + "\n$AN_CEC_OUTPUT_AXIS[" + t + "]=" + axis +
           "\n" + range_lines("AN_CEC", t, s) + "$AN_CEC_DIRECTION[" + t +
           "]=" + std::to_string(direction) + "\n$AN_CEC_MULT_BY_TABLE[" + t + "]=0\n";
  }
  return out + "M17\n";
}

Expected<std::vector<Artifact>> files(const Sheet& s) {
  const std::string stem = "siemens-840d-" + s.job.stem;
  if (s.directions)
    if (auto free = free_tables(first_table(s), 2, s.input.options); !free)
      return fail("axis " + s.job.axis + ": " + free.error().message);
  if (s.directions) return std::vector<Artifact>{{stem + "-CEC.ini", direction_tables(s)}};
  std::vector<Artifact> out{{stem + "-EEC.ini", encoder_table(s)}};
  if (s.job.curve.bidirectional()) out.push_back({stem + "-backlash.ini", backlash_file(s)});
  return out;
}

Expected<OutputResult> write(const ControllerInput& input) {
  OutputResult result;
  auto table = controllers::chosen(declared(), input.options);
  if (!input.options.flag("directions")) table->facts.pop_back();
  const controllers::Writer writer{.name = "siemens-840d",
                                   .table = *table,
                                   .keys = {"number:", "step", "first", "reference", "backlash"},
                                   .files = files,
                                   .parse = parse,
                                   .holds_documented = true};
  NONIO_TRY(const auto jobs, controllers::write_axes(input, writer, result));
  for (const AxisJob& job : jobs)
    if (job.loaded && input.options.flag("directions") && job.curve.bidirectional())
      note_chosen(job.axis,
                  input.options.integer("first_cec_table") +
                      2 * (static_cast<std::int64_t>(job.number) - 1),
                  2, result);
  if (auto done = write_cross_tables(input, jobs, result); !done)
    return tl::unexpected<Error>(done.error());
  controllers::note_facts(writer, result);
  return result;
}

std::vector<Option> options() {
  std::vector<Option> list = controllers::table_options(
      declared(),
      "number (n of AXn), step_mm, first_mm, reference_mm, backlash_mm (MD32450 while measured), "
      "and the same with _deg",
      {within(0.0, 1.0, {"measuring_system", std::int64_t{0}, "", "Encoder: 0 first, 1 second."}),
       within(0.0, 120.0,
              {"first_cec_table", std::int64_t{0}, "",
               "Number of the first CEC table; axis n takes this + 2 (n - 1) and the next."}),
       {"taken", std::vector<std::string>{}, "",
        "Numbers of CEC tables that are in use in the control, \"0\", \"4-9\": none of them is "
        "written."},
       controllers::squareness_option(),
       {"quoted_axes", false, "", "CEC axes as \"AX1\" (newer) and not as (AX1)."}});
  return list;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"siemens-840d", "1.1.0",
       "Leadscrew error tables (EEC), direction tables (CEC) and backlash for SINUMERIK.",
       options()},
      declared(), write, parse, controllers::Offered::always);
  controller.merge = merge;
  registry.add(std::move(controller));
}

}  // namespace nonio::siemens_840d
