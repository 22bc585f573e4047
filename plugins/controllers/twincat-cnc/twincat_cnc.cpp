// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "nonio/controllers/list.h"
#include "nonio/controllers/replay.h"
#include "nonio/controllers/text.h"
#include "nonio/sdk/plugin.h"

namespace nonio::twincat_cnc {

namespace {

constexpr std::string_view lose_key = "getriebe[0].lose";

std::string_view first_word(std::string_view line) {
  const auto words = controllers::words_of(line);
  return words.empty() ? std::string_view() : words.front();
}

bool is_table(std::string_view line) { return first_word(line).starts_with("kw.ssfk."); }

/// "# P-AXIS-00103 getriebe[0].lose = 40"
bool is_word(std::string_view line) {
  return line.starts_with("# P-AXIS-00103 ") && line.find(lose_key) != std::string_view::npos;
}

std::optional<std::int64_t> number_of(const std::string& list) {
  for (const std::string_view line : controllers::lines_of(list))
    if (const auto words = controllers::words_of(line);
        words.size() > 1 && (words[0] == "kopf.achs_nr" || words[0] == "kopf.log_achs_nr"))
      return controllers::whole(words[1]);
  return std::nullopt;
}

std::string lose_of(std::string_view word) {
  const auto words =
      controllers::words_of(word.substr(word.find(lose_key) + lose_key.size()), " =\t\r");
  return words.empty() ? std::string() : std::string(words.front());
}

/// Replaces kw.ssfk in the list of the axis; other content such as kw.crosscomp is kept.
Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  const Artifact* table = nullptr;
  for (const Artifact& f : in.table)
    if (f.bytes.find("kw.ssfk.") != std::string::npos) table = &f;
  const auto number = table == nullptr ? std::nullopt : number_of(table->bytes);
  if (!number) return fail("no new table of axis " + in.axis);
  std::string fresh, value;
  for (const std::string_view line : controllers::lines_of(table->bytes)) {
    if (is_word(line)) value = lose_of(line);
    if (line.starts_with('#') || is_table(line)) fresh += std::string(line) + "\n";
  }
  std::vector<Artifact> out;
  for (const Artifact& f : in.backup) {
    if (number_of(f.bytes) != number) continue;
    if (!out.empty())
      return fail("two files of the backup are lists of axis " + std::to_string(*number));
    const std::string kept =
        controllers::without_origin(f.bytes, "#", in.axis, [](std::string_view) { return true; });
    auto text = *controllers::with_lines(
        kept, [](std::string_view line) { return is_table(line) || is_word(line); }, fresh,
        kept.size());
    if (!value.empty())
      if (auto with_value = controllers::with_lines(
              text, [](std::string_view line) { return first_word(line) == lose_key; },
              std::string(lose_key) + "  " + value + "\n", {}))
        text = std::move(*with_value);
    out.push_back({f.name, std::move(text)});
  }
  if (out.empty())
    return fail("the backup holds no list of axis " + std::to_string(*number) +
                " (kopf.achs_nr): load the new list as it is");
  return out;
}

using Confidence = ControlTable::Confidence;
using controllers::CrossCurve;
using controllers::CrossJob;
using controllers::Sheet;

// kw.ssfk: actual - setpoint in 0.1 um or 0.0001 deg, for both directions. kw.crosscomp: of a slave
// axis by the position of its master; its sign is not documented.
ControlTable declared() {
  ControlTable t;
  t.name = "kw.ssfk, kw.crosscomp";
  t.zero = ControlTable::Zero::reference;
  t.position_unit = t.position_step = {1e-7, 1e-4 / deg_per_rad};
  t.value_unit = t.value_step = t.position_unit;
  t.points = 1500;
  t.largest = 2147483647.0;
  t.bidirectional = t.straightness = t.squareness = true;
  t.backlash = "P-AXIS-00103 getriebe[0].lose";
  t.facts = {
      {"sign-ssfk", Confidence::documented, "delta = actual - setpoint."},
      {"head", Confidence::inferred,
       "Inferred: the key kopf.achs_nr is written; kopf.log_achs_nr of another page of the maker "
       "is "
       "read too. Inferred: equal ends of a modulo table."},
      {"cross", Confidence::unsure,
       "Cross tables (kw.crosscomp): the maker does not state which sign they have, nor surely "
       "whose list they belong to; they are written only where option cross_sign states it."}};
  return t;
}

std::string line(const std::string& key, const std::string& value) {
  return key + std::string(key.size() < 30 ? 30 - key.size() : 1, ' ') + value + "\n";
}

std::string head(const std::vector<std::string>& words, std::size_t number,
                 const std::string& name) {
  return controllers::comments(words, "# ") + line("kopf.achs_nr", std::to_string(number)) +
         line("kopf.log_achs_name", controllers::plain(name));
}

// P-AXIS-00103 has 16 bits and the unit of the lists, 0.1 um (0.0001 deg).
constexpr std::int64_t most_lose = 32767;

/// The backlash is in units of the parameter instead of mm. Error: it exceeds 16 bits.
Expected<std::vector<std::string>> words_with_lose(const Sheet& s) {
  std::vector<std::string> words = s.words();
  const double unit = s.position_unit();
  const std::int64_t lose = std::llround(s.backlash() / unit);
  if (std::abs(lose) > most_lose)
    return fail("axis " + s.job.axis + ": P-AXIS-00103 would be " + std::to_string(lose) +
                ", the control accepts -32768..32767: repair the axis");
  for (std::string& line : words)
    if (line.rfind(s.table.backlash + " = ", 0) == 0)
      line = s.table.backlash + " = " + std::to_string(lose) +
             (s.job.rotary ? " (a whole number of 0.0001 deg: " : " (a whole number of 0.1 um: ") +
             with_unit(s.job, static_cast<double>(lose) * unit, 6) + ")";
  return words;
}

Expected<std::vector<Artifact>> files(const Sheet& s) {
  NONIO_TRY(const auto words, words_with_lose(s));
  const auto units = [&](double x) { return std::to_string(std::llround(x / s.position_unit())); };
  std::string out = head(words, s.job.number, s.job.axis);
  out += line("kw.ssfk.unit", "1") + line("kw.ssfk.interval", units(s.grid.step)) +
         line("kw.ssfk.kw_startpos", units(s.grid.first)) +
         line("kw.ssfk.kw_nr_max", std::to_string(s.grid.points)) +
         line("kw.ssfk.bilateral", s.directions ? "1" : "0") +
         line("kw.ssfk.modulo", s.job.turn ? "1" : "0");
  for (const auto& [side, steps] : {std::pair{".pos", &s.plus_steps}, {".neg", &s.minus_steps}})
    for (std::size_t i = 0; i < steps->size(); ++i)
      out += line("kw.ssfk.table[" + std::to_string(i) + "]" + side, std::to_string((*steps)[i]));
  return std::vector<Artifact>{{"twincat-cnc-" + s.job.stem + ".lis", out}};
}

using List = std::map<std::string, double, std::less<>>;

List read_list(std::string_view bytes) {
  List list;
  for (std::string_view text : controllers::lines_of(bytes)) {
    text = text.substr(0, std::min(text.find('#'), text.find("/*")));
    const auto words = controllers::words_of(text);
    if (const auto v = controllers::real(words.size() == 2 ? words[1] : ""))
      list[std::string(words[0])] = *v;
  }
  return list;
}

std::vector<double> column(const List& list, const std::string& table, const std::string& side) {
  std::vector<double> out;
  for (;;) {
    const auto it = list.find(table + "[" + std::to_string(out.size()) + "]" + side);
    if (it == list.end()) return out;
    out.push_back(it->second);
  }
}

Expected<LoadedTable> screw(const List& list, const controllers::KnownAxis& axis) {
  const auto at = [&](const char* key) {
    const auto it = list.find(std::string("kw.ssfk.") + key);
    return it == list.end() ? NAN : it->second;
  };
  controllers::RawTable raw{axis, column(list, "kw.ssfk.table", ".setpoint"),
                            column(list, "kw.ssfk.table", ".pos")};
  if (at("unit") != 1.0)
    return fail("kw.ssfk.unit is not 1: encoder increments are not known here");
  if (static_cast<double>(raw.plus.size()) != at("kw_nr_max"))
    return fail("kw.ssfk.kw_nr_max is not the number of entries");
  if (at("interval") > 0.0) raw.position.clear();
  for (std::size_t i = raw.position.size(); i < raw.plus.size(); ++i)
    raw.position.push_back(at("kw_startpos") + at("interval") * static_cast<double>(i));
  const bool both = at("bilateral") == 1.0;
  if (both) raw.minus = column(list, "kw.ssfk.table", ".neg"), raw.backlash = 0.0;
  if (both && raw.minus.size() != raw.plus.size())
    return fail("kw.ssfk.table has not as many entries neg as pos");
  if (at("modulo") == 1.0) raw.outside = LoadedTable::Outside::repeats;
  return controllers::loaded(declared(), raw);
}

Expected<LoadedTable> cross(const List& list, const std::vector<controllers::KnownAxis>& axes,
                            const controllers::KnownAxis& slave, double sign) {
  const auto master = list.find("kw.crosscomp.master_ax_nr");
  if (master == list.end() || !(master->second >= 1.0 && master->second < 1e6))
    return fail("no kw.crosscomp.master_ax_nr");
  LoadedTable t{.output = slave.name,
                .input = {axis_numbered(axes, static_cast<std::size_t>(master->second)).name},
                .position = {column(list, "kw.crosscomp.table", ".setpoint")},
                .plus = column(list, "kw.crosscomp.table", ".correction"),
                .minus = {}};
  const auto last = list.find("kw.crosscomp.last_index");
  if (last == list.end() || static_cast<double>(t.plus.size()) != last->second + 1.0)
    return fail("kw.crosscomp.last_index is not that of the last entry");
  for (double& x : t.position[0]) x *= 1e-7;
  for (double& v : t.plus) v *= sign * 1e-7;
  if (auto ok = math::validate_table(t); !ok) return tl::unexpected<Error>(ok.error());
  return t;
}

std::optional<double> lose_in(std::string_view bytes, bool rotary) {
  const std::size_t at = bytes.find(lose_key);
  if (at == std::string_view::npos) return std::nullopt;
  const auto words = controllers::words_of(bytes.substr(at + lose_key.size(), 60), " =\t\r\n");
  const auto v = controllers::whole(words.empty() ? "" : words.front());
  return v ? std::optional(static_cast<double>(*v) * declared().position_unit.of(rotary))
           : std::nullopt;
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  NONIO_TRY(const auto axes, controllers::known_axes(in));
  const std::string said = in.options.text("cross_sign");
  std::vector<LoadedTable> tables;
  for (const Artifact& f : in.files) {
    if (auto ended = controllers::ends_whole(f.name, f.bytes); !ended)
      return tl::unexpected<Error>(ended.error());
    const List list = read_list(f.bytes);
    auto number = list.find("kopf.achs_nr");
    const auto logical = list.find("kopf.log_achs_nr");
    if (number != list.end() && logical != list.end() && number->second != logical->second)
      return controllers::fail_at(f.name, 1, "kopf.achs_nr and kopf.log_achs_nr differ");
    if (number == list.end()) number = logical;
    if (number == list.end() || !(number->second >= 1.0 && number->second < 1e6)) {
      const std::string missing = "no kopf.achs_nr, nor kopf.log_achs_nr";
      if (f.bytes.find("kw.") == std::string::npos) return fail(missing);
      return controllers::fail_at(f.name, 1, missing);
    }
    const auto axis = axis_numbered(axes, static_cast<std::size_t>(number->second));
    if (list.count("kw.ssfk.kw_nr_max") != 0) {
      NONIO_TRY(auto read, screw(list, axis));
      if (!read.backlash) read.backlash = lose_in(f.bytes, axis.rotary);
      tables.push_back(std::move(read));
    }
    if (list.count("kw.crosscomp.last_index") == 0) continue;
    if (said.empty()) return fail("the sign of kw.crosscomp is not known: set cross_sign");
    NONIO_TRY(auto read, cross(list, axes, axis, said == "error" ? -1.0 : 1.0));
    tables.push_back(std::move(read));
  }
  return tables;
}

std::string cross_list(const CrossCurve& c, const std::vector<controllers::KnownAxis>& axes,
                       double sign, const CrossJob& job) {
  const auto units = [](double x) { return std::to_string(std::llround(x / 1e-7)); };
  std::vector<std::string> words{"from the diagonals of " + controllers::plain(job.measurement),
                                 "compensation of " + controllers::plain(c.output) +
                                     " by the position of " + controllers::plain(c.input),
                                 controllers::cross_words(c, 1e-7, c.position)};
  for (std::string& line : controllers::set_words(job)) words.push_back(std::move(line));
  std::string out = head(words, axis_named(axes, c.output).number, c.output);
  out += line("kw.crosscomp.unit", "1") +
         line("kw.crosscomp.last_index", std::to_string(c.position.size() - 1)) +
         line("kw.crosscomp.master_ax_nr", std::to_string(axis_named(axes, c.input).number)) +
         line("kw.crosscomp.n_cycles", "0");
  for (std::size_t i = 0; i < c.position.size(); ++i) {
    const std::string row = "kw.crosscomp.table[" + std::to_string(i) + "]";
    out += line(row + ".setpoint", units(c.position[i])) +
           line(row + ".correction", units(sign * c.value[i]));
  }
  return out;
}

/// Step diagonals are skipped, because a slave has only one master.
Expected<void> write_cross(const ControllerInput& in,
                           const std::vector<controllers::AxisJob>& pitch, OutputResult& result) {
  const std::string said = in.options.text("cross_sign");
  const Campaign campaign = controllers::with_axes_of(in, pitch);
  NONIO_TRY(const auto axes, controllers::known_axes({{}, campaign, in.options}));
  if (said.empty()) return {};
  const auto jobs = controllers::cross_jobs(in, controllers::SecondSide::own_table, result);
  for (const CrossJob& job : jobs) {
    if (job.volume) {
      result.notes.push_back(controllers::not_in_format("twincat-cnc", job.measurement));
      continue;
    }
    if (auto ok = controllers::fits(job, in.options); !ok) return ok;
    if (controllers::lacks_number(job.moving(), in, axes, job.measurement, result)) continue;
    if (controllers::oversized(job, in, result)) continue;
    std::vector<Artifact> files;
    for (const CrossCurve& c : job.curves)
      files.push_back({"twincat-cnc-cross-" + controllers::file_part(c.output) +
                           (jobs.size() > 1 ? "-" + controllers::file_part(job.measurement) : "") +
                           ".lis",
                       cross_list(c, axes, said == "error" ? 1.0 : -1.0, job)});
    if (auto done = controllers::predict_cross(job, files, parse, pitch, in, result); !done)
      return done;
    for (Artifact& f : files) result.artifacts.push_back(std::move(f));
  }
  return {};
}

Expected<OutputResult> write(const ControllerInput& in) {
  OutputResult result;
  const controllers::Writer writer{
      .name = "twincat-cnc",
      .table = *controllers::chosen(declared(), in.options),
      .keys = {"number:", "step", "first", "reference", "backlash"},
      .files = files,
      .parse = parse,
      .directions = controllers::Directions::by_option_without_backlash,
      .backlash_in_steps = true};
  NONIO_TRY(const auto jobs, controllers::write_axes(in, writer, result));
  if (auto done = write_cross(in, jobs, result); !done) return tl::unexpected<Error>(done.error());
  controllers::note_facts(writer, result);
  return result;
}

std::vector<Option> options() {
  return controllers::table_options(
      declared(),
      "number (of the axis), step_mm, first_mm, reference_mm, backlash_mm, and the same with _deg",
      {one_of({"", "error", "correction"},
              {"cross_sign", std::string(), "",
               "What an entry of kw.crosscomp is, as a sign probe showed it: the error, or the "
               "correction; no cross tables before it is said."}),
       controllers::squareness_option()});
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"twincat-cnc", "1.0.0",
       "Correction lists (kw.ssfk, kw.crosscomp) for Beckhoff TwinCAT CNC and the ISG kernel.",
       options()},
      declared(), write, parse);
  controller.merge = merge;
  registry.add(std::move(controller));
}

}  // namespace nonio::twincat_cnc
