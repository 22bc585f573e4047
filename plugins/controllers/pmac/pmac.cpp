// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "nonio/controllers/list.h"

namespace nonio::pmac {
namespace {

using Confidence = ControlTable::Confidence;
using controllers::AxisJob;
using controllers::Sheet;

// #motor DEFINE COMP entries,span: motor - load in 1/16 count at 1, 2, ... spacings from motor
// zero, where it is 0; the table rolls over, so that negative positions are its second half.
ControlTable declared() {
  ControlTable t;
  t.name = "DEFINE COMP";
  t.sign = ControlTable::Sign::correction;
  t.zero = ControlTable::Zero::first;
  t.points = 4096;
  t.backlash = "Ix86 (Ixx86)";
  t.facts = {{"sign", Confidence::documented, "The maker's printed numbers: motor less load."},
             {"blcomp", Confidence::documented, "Not written: DEFINE BLCOMP, other target motors."},
             {"points", Confidence::unsure, "Unsure: how many entries a motor can have."}};
  t.runs_gcode = false;
  return t;
}

/// Counts of the encoder per mm or deg: every length of the file is in counts.
Expected<ControlTable> in_counts(const controllers::AxisSettings& settings, const std::string& axis,
                                 bool rotary, ControlTable t) {
  const auto counts = settings.find(rotary ? "counts_per_deg" : "counts_per_mm");
  if (counts == settings.end() || !(counts->second > 0.0))
    return controllers::wrong_axes("axis " + axis + ": how many counts has the encoder? Set " +
                                   (rotary ? "counts_per_deg" : "counts_per_mm") +
                                   " = ... under [options.pmac.axes." + axis + "]");
  const double count = 1.0 / (counts->second * (rotary ? deg_per_rad : 1e3));
  t.position_unit = t.position_step = {count, count};
  t.value_unit = t.value_step = {count / 16.0, count / 16.0};
  return t;
}

/// Entries that hold the value of an end outside of the readings: as far as the travel goes, or a
/// tenth of the table where it is not stated. Without them the table goes on at its other end.
struct Held {
  std::size_t below = 0, above = 0;
};

Held held_of(const Sheet& s) {
  const Axis* const axis = s.input.campaign.machine.axis(s.job.axis);
  const double first = s.grid.first, last = s.grid.last();
  double low = first - 0.1 * (last - first), high = last + 0.1 * (last - first);
  if (axis != nullptr && axis->travel)
    low = std::min(axis->travel->first, axis->travel->second),
    high = std::max(axis->travel->first, axis->travel->second);
  const auto steps = [&](double way) {
    return static_cast<std::size_t>(std::max(0.0, std::ceil(way / s.grid.step - 1e-6)));
  };
  Held held{steps(first - low), steps(high - last)};
  const std::size_t room =
      s.table.points > s.plus_steps.size() ? s.table.points - s.plus_steps.size() : 0;
  if (held.below + held.above > room) held = {};
  return held;
}

Expected<std::vector<Artifact>> files(const Sheet& s) {
  const auto& q = s.plus_steps;
  const auto below = static_cast<std::size_t>(std::llround(-s.grid.first / s.grid.step));
  const bool turn = s.job.turn.has_value();
  const Held held = turn ? Held{} : held_of(s);
  std::vector<std::int64_t> circle;  // from motor zero upwards; negative positions come last
  for (std::size_t i = below + 1; i < q.size() - (turn ? 1 : 0); ++i) circle.push_back(q[i]);
  circle.insert(circle.end(), held.above, q.back());
  circle.insert(circle.end(), held.below, q.front());
  for (std::size_t i = 0; i < below; ++i) circle.push_back(q[i]);
  circle.push_back(0);
  const std::size_t entries = circle.size();
  const auto spacing = std::llround(s.grid.step / s.position_unit());
  std::string out = "#" + std::to_string(s.job.number) + " DEFINE COMP " + std::to_string(entries) +
                    "," + std::to_string(static_cast<std::int64_t>(entries) * spacing) + "\n";
  for (std::size_t k = 1; k <= entries; ++k)
    out += std::to_string(circle[k - 1]) + (k % 8 == 0 || k == entries ? "\n" : " ");
  std::vector<std::string> words = s.words();
  for (std::string& line : words) {
    if (line.starts_with(controllers::points_said))
      line = "entries in this table: " + std::to_string(entries);
    if (!turn && line == s.outside_words())
      line = "from " +
             controllers::with_unit(
                 s.job, s.grid.first - s.grid.step * static_cast<double>(held.below), 4) +
             " to " +
             controllers::with_unit(
                 s.job, s.grid.last() + s.grid.step * static_cast<double>(held.above), 4) +
             " the value of the nearest end holds; outside of it the table goes on at its other "
             "end";
  }
  words.push_back("Ix86 in 1/16 count: " +
                  std::to_string(std::llround(s.backlash() / s.value_unit())));
  words.emplace_back("define the tables of motors with larger numbers first; I51 = 1 enables");
  const std::string stem = "pmac-" + s.job.stem;
  return std::vector<Artifact>{{stem + ".pmc", out},
                               {stem + ".txt", controllers::comments(words, "")}};
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  const auto axes = controllers::known_axes(in);
  if (!axes) return tl::unexpected<Error>(axes.error());
  std::vector<LoadedTable> tables;
  std::map<std::string, double> backlash;
  for (const Artifact& f : in.files) {
    if (f.bytes.rfind('#', 0) != 0) {  // the text that goes with it
      if (const auto v = controllers::parameter_in(f.bytes, declared().backlash))
        backlash[axis_of_file(*axes, f.name, "pmac-").name] = *v;
      continue;
    }
    const auto w = controllers::words_of(f.bytes, " ,\t\r\n");
    const auto motor = controllers::whole(w[0].substr(1));
    const auto entries = controllers::whole(w.size() > 4 ? w[3] : ""),
               span = controllers::whole(w.size() > 4 ? w[4] : "");
    if (!motor || !entries || !span || w[1] != "DEFINE" || w[2] != "COMP" || *entries < 2 ||
        *span < *entries || w.size() != static_cast<std::size_t>(*entries) + 5)
      return fail("not a table \"#n DEFINE COMP entries,span\" with as many entries");
    controllers::RawTable raw{axis_numbered(*axes, static_cast<std::size_t>(*motor)), {0.0}, {0.0}};
    raw.outside = LoadedTable::Outside::repeats;
    for (std::int64_t k = 1; k <= *entries; ++k) {
      const auto v = controllers::whole(w[static_cast<std::size_t>(k) + 4]);
      if (!v) return fail("not an entry: " + std::string(w[static_cast<std::size_t>(k) + 4]));
      raw.position.push_back(static_cast<double>(k * *span) / static_cast<double>(*entries));
      raw.plus.push_back(static_cast<double>(*v));
    }
    const auto t = in_counts(raw.axis.settings, raw.axis.name, raw.axis.rotary, declared());
    if (!t) return tl::unexpected<Error>(t.error());
    auto read = controllers::loaded(*t, raw);
    if (!read) return tl::unexpected<Error>(read.error());
    tables.push_back(std::move(*read));
  }
  if (tables.empty()) return fail("no DEFINE COMP");
  for (LoadedTable& t : tables)
    if (const auto it = backlash.find(t.output); it != backlash.end()) t.backlash = it->second;
  return tables;
}

Expected<OutputResult> write(const ControllerInput& in) {
  return controllers::write_tables(in, {.name = "pmac",
                                        .table = *controllers::chosen(declared(), in.options),
                                        .keys = {"number:", "counts_per", "step", "backlash"},
                                        .files = files,
                                        .parse = parse,
                                        .of_axis = [](const AxisJob& job, ControlTable t) {
                                          return in_counts(job.settings, job.axis, job.rotary,
                                                           std::move(t));
                                        }});
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(controllers::controller(
      {"pmac", "1.0.0", "Leadscrew compensation tables (DEFINE COMP) for PMAC and Turbo PMAC.",
       controllers::table_options(declared(),
                                  "number (of the motor), counts_per_mm or counts_per_deg "
                                  "(always), step_mm, backlash_mm")},
      declared(), write, parse));
}

}  // namespace nonio::pmac
