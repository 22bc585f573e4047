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

// #motor DEFINE COMP entries,span: (motor - load) in 1/16 count at 1, 2, ... spacings from motor
// zero, where it is 0. The table is periodic, so its second half has the negative positions.
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

/// In encoder counts per mm or deg, because the file contains only counts.
Expected<ControlTable> in_counts(const controllers::AxisSettings& settings, const std::string& axis,
                                 bool rotary, ControlTable t) {
  const auto counts = settings.find(rotary ? "counts_per_deg" : "counts_per_mm");
  if (counts == settings.end() || !(counts->second > 0.0))
    return controllers::wrong_axes(
        "axis " + axis + ": how many counts has the encoder? Set " +
        (rotary ? "counts_per_deg" : "counts_per_mm") + " = ... under [options.pmac.axes." + axis +
        "], or for two files --axis X --set \"axes=X number=3 counts_per_mm=...\"");
  const double count = 1.0 / (counts->second * (rotary ? deg_per_rad : 1e3));
  t.position_unit = t.position_step = {count, count};
  t.value_unit = t.value_step = {count / 16.0, count / 16.0};
  return t;
}

/// Numbers of entries outside of the readings that repeat the end value: to the end of the travel,
/// or a tenth of the table if no travel is stated. Without them, the value would jump to that of
/// the other end.
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
  std::vector<std::int64_t> circle;  // from motor zero upwards, then the negative positions
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

struct Word {
  std::string text;
  std::size_t line = 0;
};

std::vector<Word> words_in(std::string_view bytes) {
  std::vector<Word> out;
  std::size_t number = 0;
  for (std::string_view line : controllers::lines_of(bytes)) {
    ++number;
    line = line.substr(0, std::min(line.find(';'), line.find("//")));
    for (const std::string_view word : controllers::words_of(line, " ,\t\r")) {
      std::string text(word);
      for (char& c : text)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
      out.push_back({std::move(text), number});
    }
  }
  return out;
}

/// #motor DEFINE COMP entries[,#source[,#target]],span and its entries. The motor may be addressed
/// by an earlier line.
struct Definition {
  std::size_t motor = 0, source = 0, target = 0;
  std::int64_t entries = 0, span = 0;
  std::vector<double> values{};
  std::size_t line = 0;
};

class Definitions {
 public:
  Definitions(const Artifact& file) : file_(file), words_(words_in(file.bytes)) {}

  Expected<std::vector<Definition>> all() {
    std::vector<Definition> out;
    while (at_ < words_.size()) {
      if (const auto motor = motor_at(at_)) {
        motor_ = *motor;
        ++at_;
      } else if (is("DELETE") || is("DEL")) {
        at_ += 2;
      } else if (is("DEFINE") || is("DEF")) {
        NONIO_TRY(auto one, definition());
        out.push_back(std::move(one));
      } else if (!out.empty() || motor_ != 0) {
        return wrong("expected #motor or DEFINE COMP, found " + words_[at_].text);
      } else {
        return out;
      }
    }
    return out;
  }

 private:
  bool is(std::string_view word, std::size_t ahead = 0) const {
    return at_ + ahead < words_.size() && words_[at_ + ahead].text == word;
  }
  std::optional<std::size_t> motor_at(std::size_t i) const {
    if (i >= words_.size() || !words_[i].text.starts_with('#')) return std::nullopt;
    std::string_view number = std::string_view(words_[i].text).substr(1);
    if (number.ends_with('D')) number.remove_suffix(1);  // table indexed by desired position
    const auto motor = controllers::whole(number);
    if (!motor || *motor < 1 || *motor > 1000) return std::nullopt;
    return static_cast<std::size_t>(*motor);
  }
  std::optional<std::int64_t> number() {
    const auto value = at_ < words_.size() ? controllers::whole(words_[at_].text) : std::nullopt;
    if (value) ++at_;
    return value;
  }
  tl::unexpected<Error> wrong(const std::string& message) const {
    const std::size_t last = words_.empty() ? 1 : words_.back().line;
    return controllers::fail_at(file_.name, at_ < words_.size() ? words_[at_].line : last, message);
  }

  Expected<Definition> definition() {
    if (!is("COMP", 1))
      return wrong("only DEFINE COMP is read, found " + words_[at_].text +
                   (at_ + 1 < words_.size() ? " " + words_[at_ + 1].text : ""));
    Definition d{motor_, motor_, motor_};
    d.line = words_[at_].line;
    if (motor_ == 0) return wrong("expected the motor (#1) before DEFINE COMP");
    at_ += 2;
    const auto entries = number();
    if (!entries) return wrong("expected the number of entries; tables of two axes are not read");
    if (const auto source = motor_at(at_)) d.source = d.target = *source, ++at_;
    if (const auto target = motor_at(at_)) d.target = *target, ++at_;
    const auto span = number();
    if (!span || *entries < 2 || *entries > 100000 || *span < *entries)
      return wrong("expected a count of entries from 2 and a length in counts, not shorter");
    d.entries = *entries;
    d.span = *span;
    while (d.values.size() < static_cast<std::size_t>(d.entries)) {
      const auto value = number();
      if (!value)
        return wrong("expected " + std::to_string(d.entries) + " entries of motor " +
                     std::to_string(d.motor) + ", found " + std::to_string(d.values.size()) +
                     (at_ < words_.size() ? " before " + words_[at_].text : ""));
      d.values.push_back(static_cast<double>(*value));
    }
    if (at_ < words_.size() && controllers::whole(words_[at_].text))
      return wrong("expected " + std::to_string(d.entries) + " entries of motor " +
                   std::to_string(d.motor) + ", found more");
    return d;
  }

  const Artifact& file_;
  std::vector<Word> words_;
  std::size_t at_ = 0, motor_ = 0;
};

/// The axis of the target motor; if source and target are equal and the target is unknown, the axis
/// of the motor that stores the table.
controllers::KnownAxis axis_of(const std::vector<controllers::KnownAxis>& axes,
                               const Definition& d) {
  controllers::KnownAxis target = axis_numbered(axes, d.target);
  const bool known = !target.settings.empty();
  return known || d.source != d.target ? target : axis_numbered(axes, d.motor);
}

Expected<LoadedTable> table_of(const Definition& d, const controllers::KnownAxis& axis,
                               const controllers::KnownAxis& source) {
  controllers::RawTable raw{axis, {0.0}, {0.0}};
  raw.outside = LoadedTable::Outside::repeats;
  for (std::int64_t k = 1; k <= d.entries; ++k) {
    raw.position.push_back(static_cast<double>(k * d.span) / static_cast<double>(d.entries));
    raw.plus.push_back(d.values[static_cast<std::size_t>(k) - 1]);
  }
  NONIO_TRY(const auto t, in_counts(raw.axis.settings, raw.axis.name, raw.axis.rotary, declared()));
  NONIO_TRY(auto read, controllers::loaded(t, raw));
  if (source.name == axis.name) return read;
  NONIO_TRY(const auto of_source,
            in_counts(source.settings, source.name, source.rotary, declared()));
  for (double& x : read.position.front())
    x *= of_source.position_unit.of(source.rotary) / t.position_unit.of(axis.rotary);
  read.input = {source.name};
  return read;
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  NONIO_TRY(const auto axes, controllers::known_axes(in));
  std::vector<LoadedTable> tables;
  std::map<std::string, double> backlash;
  std::optional<Error> unknown;
  for (const Artifact& f : in.files) {
    NONIO_TRY(const auto all, Definitions(f).all());
    if (all.empty()) {
      if (const auto v = controllers::parameter_in(f.bytes, declared().backlash))
        backlash[axis_of_file(axes, f.name, "pmac-").name] = *v;
      continue;
    }
    for (const Definition& d : all) {
      const controllers::KnownAxis axis = axis_of(axes, d);
      auto read = table_of(d, axis, d.source == d.target ? axis : axis_numbered(axes, d.source));
      if (read) {
        tables.push_back(std::move(*read));
      } else {
        unknown = controllers::fail_at(f.name, d.line, read.error().message).value();
        if (!axis.settings.empty()) return tl::unexpected<Error>(*unknown);
      }
    }
  }
  if (tables.empty()) return unknown ? tl::unexpected<Error>(*unknown) : fail("no DEFINE COMP");
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
                                        .backlash_in_steps = true,
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
