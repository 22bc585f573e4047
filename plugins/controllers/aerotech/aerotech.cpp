// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/controllers/list.h"
#include "nonio/controllers/replay.h"
#include "nonio/controllers/text.h"
#include "nonio/sdk/plugin.h"

namespace nonio::aerotech {

namespace {

class Blocks {
 public:
  std::int64_t axis_of(std::string_view line) {
    const auto words = controllers::words_of(line.substr(0, line.find_first_of(";'")));
    if (words.empty()) return axis_;
    const bool starts = words[0] == ":START" && !open_;
    if (starts)
      axis_ = controllers::whole(words.size() > 1 ? words[1] : std::string_view()).value_or(0);
    open_ = open_ || words[0].starts_with(":START");
    const std::int64_t here = axis_;
    if (words[0] == ":END") open_ = false, axis_ = 0;
    return here;
  }

 private:
  std::int64_t axis_ = 0;
  bool open_ = false;
};

bool has_tables(const std::string& text) { return text.find(":START") != std::string::npos; }

/// Replaces the tables of one axis (:START n ... :END) in a backup; other axes and planes are kept.
Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  std::string fresh, words;
  std::int64_t axis = 0;
  Blocks blocks;
  for (const Artifact& f : in.table)
    for (const std::string_view line : controllers::lines_of(f.bytes)) {
      if (const std::int64_t of = blocks.axis_of(line); of != 0) {
        axis = of;
        fresh += words + std::string(line) + "\n";
        words.clear();
      } else if (line.starts_with(';')) {
        words += std::string(line) + "\n";
      }
    }
  if (axis == 0) return fail("no new table of axis " + in.axis);
  std::vector<Artifact> out;
  for (const Artifact& f : in.backup) {
    Blocks of_file;
    auto text = controllers::with_lines(
        controllers::without_origin(f.bytes, ";", in.axis, [](std::string_view) { return true; }),
        [&](std::string_view line) { return of_file.axis_of(line) == axis; }, fresh, {});
    if (!text) continue;
    if (!out.empty())
      return fail("two files of the backup hold tables of axis " + std::to_string(axis) +
                  ": the control adds them; take one out first");
    out.push_back({f.name, std::move(*text)});
  }
  for (const Artifact& f : in.backup)
    if (out.empty() && has_tables(f.bytes))
      out.push_back(
          {f.name, *controllers::with_lines(
                       f.bytes, [](std::string_view) { return false; }, fresh, f.bytes.size())});
  if (out.empty()) return fail("the backup holds no table (:START)");
  return out;
}

using Confidence = ControlTable::Confidence;
using controllers::CrossCurve;
using controllers::CrossJob;
using controllers::Sheet;

// .cal: corrections at equal distances from home. The control adds all tables of an axis, and
// beyond a table its end value applies, so that one table for each side of home suffices. A table
// of a whole revolution is not repeated.
ControlTable declared() {
  ControlTable t;
  t.name = ".cal";
  t.sign = ControlTable::Sign::correction;
  t.zero = ControlTable::Zero::first;
  t.points = 10000;
  t.straightness = t.squareness = true;
  t.facts = {
      {"sign", Confidence::inferred, "Inferred: the sign -e, from three generators of such files."},
      {"form", Confidence::inferred,
       "Inferred: units PRIMARY and METRIC/1000, and the order of the words after :START2D; "
       "compare with a .cal file of the machine."},
      {"directions", Confidence::documented, "One correction for both directions."}};
  return t;
}

constexpr std::string_view two_tables = "two tables from home";

Expected<std::vector<Artifact>> files(const Sheet& s) {
  const auto below = std::llround(-s.grid.first / s.grid.step);
  const auto above = std::llround(s.grid.last() / s.grid.step);
  const auto entry = [&](std::int64_t k) {
    const std::int64_t i = k + below;
    if (i < 0 || i >= static_cast<std::int64_t>(s.plus.size())) return std::string("0.0");
    return s.entry(s.plus[static_cast<std::size_t>(i)]);
  };
  std::vector<std::string> words = s.words();
  if (below > 0 && above > 0)
    words.push_back(std::string(two_tables) +
                    ", one to each side: the control adds them, and each is 0 beyond home");
  std::string out = controllers::comments(words, "; ");
  for (const std::int64_t side : {1, -1}) {
    const std::int64_t points = side > 0 ? above : below;
    if (points <= 0) continue;
    out += ":START " + std::to_string(s.job.number) + " SAMPLEDIST=" +
           controllers::decimal(static_cast<double>(side) * s.grid.step / s.position_unit(), 4) +
           " POSUNIT=PRIMARY CORUNIT=PRIMARY\n:START HOMEOFFSET=0\n";
    for (std::int64_t k = 0; k <= points; ++k) out += entry(side * k) + "\n";
    out += ":END\n";
  }
  return std::vector<Artifact>{{"aerotech-" + s.job.stem + ".cal", std::move(out)}};
}

/// One row per position of the second axis, one column per position of the first axis; each cell
/// contains both corrections in um.
std::string plane(const CrossJob& job, const std::vector<controllers::KnownAxis>& axes) {
  const CrossCurve &a = job.curves[0], &b = job.curves[1];
  const std::string row = std::to_string(axis_named(axes, b.input).number);
  const std::string col = std::to_string(axis_named(axes, a.input).number);
  const auto step = [](const CrossCurve& c) {
    return controllers::decimal(
        (c.position.back() - c.position.front()) * 1e3 / static_cast<double>(c.position.size() - 1),
        4);
  };
  std::string out = "; straightness and squareness from the diagonals of " +
                    controllers::plain(job.measurement) + "\n; " +
                    controllers::cross_words(a, 1e-9, a.position) + "\n; " +
                    controllers::cross_words(b, 1e-9, b.position) + "\n" +
                    controllers::comments(controllers::set_words(job), "; ") + ":START2D " + row +
                    " " + col + " " + col + " " + row + " " + step(b) + " " + step(a) + " " +
                    std::to_string(a.position.size()) +
                    "\n:START2D POSUNIT=METRIC CORUNIT=METRIC/1000 OFFSETROW=0 OFFSETCOL=0\n";
  for (const double of_b : b.value) {
    std::string line;
    for (const double of_a : a.value)
      line += (line.empty() ? "" : "  ") + controllers::decimal(-of_b * 1e6, 3) + " " +
              controllers::decimal(-of_a * 1e6, 3);
    out += line + "\n";
  }
  return out + ":END\n";
}

std::vector<double> even(double step, std::size_t n) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(step * static_cast<double>(i));
  return out;
}

double value_in(const std::vector<std::string_view>& words, std::string_view key) {
  for (const auto w : words)
    if (w.rfind(key, 0) == 0) return controllers::real(w.substr(key.size())).value_or(NAN);
  return NAN;
}

/// First word after the `numbers` numbers of a head that is not in `known`, whose elements with a
/// final '=' are prefixes. Unknown words (units, NEGCOR, a third axis) change the meaning of a
/// table.
std::string_view not_understood(const std::vector<std::string_view>& head, std::size_t numbers,
                                std::initializer_list<std::string_view> known) {
  for (std::size_t i = numbers; i < head.size(); ++i)
    if (std::none_of(known.begin(), known.end(), [&](std::string_view k) {
          return k.back() == '=' ? head[i].starts_with(k) : head[i] == k;
        }))
      return head[i];
  return {};
}

struct Parser {
  const std::vector<controllers::KnownAxis>& axes;
  std::vector<LoadedTable> tables{};

  controllers::KnownAxis axis(std::string_view word) const {
    const auto n = controllers::whole(word);
    return axis_numbered(axes, n && *n > 0 ? static_cast<std::size_t>(*n) : 0);
  }
  Expected<void> line_table(const std::vector<std::string_view>& head, std::vector<double> v) {
    const auto of = axis(head.size() > 1 ? head[1] : "");
    if (const auto word = not_understood(
            head, 2,
            {":START", "HOMEOFFSET=0", "POSUNIT=PRIMARY", "CORUNIT=PRIMARY", "SAMPLEDIST="});
        !word.empty())
      return fail("a :START with " + std::string(word) + ", which is not understood");
    const double step = value_in(head, "SAMPLEDIST=");
    if (!(std::fabs(step) > 0.0) || value_in(head, "HOMEOFFSET=") != 0.0)
      return fail("a :START without SAMPLEDIST or with a HOMEOFFSET");
    controllers::RawTable raw{of, even(step, v.size()), std::move(v)};
    if (step < 0.0) {
      std::reverse(raw.position.begin(), raw.position.end());
      std::reverse(raw.plus.begin(), raw.plus.end());
    }
    NONIO_TRY(auto read, controllers::loaded(declared(), raw));
    tables.push_back(std::move(read));
    return {};
  }
  Expected<void> plane_table(const std::vector<std::string_view>& head,
                             const std::vector<double>& v) {
    const auto cols = controllers::whole(head.size() > 7 ? head[7] : "");
    const auto drow = controllers::real(head.size() > 7 ? head[5] : ""),
               dcol = controllers::real(head.size() > 7 ? head[6] : "");
    if (const auto word = not_understood(
            head, 8,
            {":START2D", "POSUNIT=METRIC", "CORUNIT=METRIC/1000", "OFFSETROW=0", "OFFSETCOL=0"});
        !word.empty())
      return fail("a :START2D with " + std::string(word) + ", which is not understood");
    if (!cols || *cols < 2 || !drow || !dcol || !(*drow > 0.0) || !(*dcol > 0.0) ||
        v.size() % static_cast<std::size_t>(2 * *cols) != 0)
      return fail("a :START2D that is not understood");
    const std::size_t n = static_cast<std::size_t>(*cols), rows = v.size() / (2 * n);
    for (std::size_t out = 0; out < 2; ++out) {
      LoadedTable t{.output = axis(head[3 + out]).name,
                    .input = {axis(head[1]).name, axis(head[2]).name},
                    .position = {even(*drow / 1e3, rows), even(*dcol / 1e3, n)},
                    .plus = {},
                    .minus = {}};
      for (std::size_t i = out; i < v.size(); i += 2) t.plus.push_back(v[i] * 1e-6);
      if (auto ok = math::validate_table(t); !ok) return ok;
      tables.push_back(std::move(t));
    }
    return {};
  }
  Expected<void> file(std::string_view bytes) {
    std::vector<std::string_view> head;
    std::vector<double> values;
    for (std::string_view line : controllers::lines_of(bytes)) {
      const auto w = controllers::words_of(line.substr(0, line.find_first_of(";'")));
      if (w.empty()) continue;
      if (w[0] == ":END") {
        const bool is_plane = !head.empty() && head[0] == ":START2D";
        if (auto done = is_plane ? plane_table(head, values) : line_table(head, values); !done)
          return done;
        head.clear(), values.clear();
      } else if (w[0].front() == ':') {
        head.insert(head.end(), w.begin(), w.end());
      } else {
        for (const auto word : w) values.push_back(controllers::real(word).value_or(NAN));
      }
    }
    return head.empty() ? Expected<void>{} : fail("a table without :END");
  }
};

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  NONIO_TRY(const auto axes, controllers::known_axes(in));
  Parser parser{axes};
  for (const Artifact& f : in.files)
    if (auto ended = controllers::ends_whole(f.name, f.bytes); !ended)
      return tl::unexpected<Error>(ended.error());
  for (const Artifact& f : in.files) {
    const std::size_t before = parser.tables.size();
    if (auto done = parser.file(f.bytes); !done) return tl::unexpected<Error>(done.error());
    if (f.bytes.find(two_tables) != f.bytes.npos && parser.tables.size() == before + 1)
      return fail(f.name + ": one of its two tables is missing: the file was cut");
  }
  if (parser.tables.empty()) return fail("no :START");
  return parser.tables;
}

Expected<OutputResult> write(const ControllerInput& in) {
  OutputResult result;
  const controllers::Writer writer{.name = "aerotech",
                                   .table = *controllers::chosen(declared(), in.options),
                                   .keys = {"number:", "step", "backlash"},
                                   .files = files,
                                   .parse = parse,
                                   .turn_end = controllers::TurnEnd::closed,
                                   .holds_documented = true};
  NONIO_TRY(const auto jobs, controllers::write_axes(in, writer, result));
  const Campaign campaign = controllers::with_axes_of(in, jobs);
  NONIO_TRY(const auto axes, controllers::known_axes({{}, campaign, in.options}));
  for (const CrossJob& set :
       controllers::cross_jobs(in, controllers::SecondSide::not_known, result)) {
    if (set.volume || set.curves.size() != 2) {
      result.notes.push_back(controllers::not_in_format(writer.name, set.measurement));
      continue;
    }
    if (controllers::lacks_number(set.moving(), in, axes, set.measurement, result)) continue;
    if (std::any_of(set.curves.begin(), set.curves.end(),
                    [](const CrossCurve& c) { return std::fabs(c.position.front()) > 1e-9; }))
      return fail("diagonals of " + set.measurement +
                  ": a plane begins at home (0), the curves do not");
    for (const CrossCurve& c : set.curves)
      if (c.reference != 0.0)
        return controllers::wrong_axes("axis " + c.input +
                                           ": a plane starts at home, where its entries are 0: "
                                           "reference_mm must be 0, found " +
                                           controllers::decimal(c.reference * 1e3, 4) + " mm",
                                       c.input + ".reference_mm");
    if (controllers::oversized(set, in, result)) continue;
    const std::vector<Artifact> file{
        {"aerotech-plane-" + controllers::file_part(set.measurement) + ".cal", plane(set, axes)}};
    if (auto done = controllers::predict_cross(set, file, parse, jobs, in, result); !done)
      return tl::unexpected<Error>(done.error());
    result.artifacts.push_back(file.front());
  }
  controllers::note_facts(writer, result);
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"aerotech", "1.0.0",
       "Axis calibration files (.cal, one and two dimensions) for Aerotech A3200 and Automation1.",
       controllers::table_options(
           declared(),
           "number (of the axis, from 1), step_mm, backlash_mm and the same with _deg")},
      declared(), write, parse);
  controller.merge = merge;
  registry.add(std::move(controller));
}

}  // namespace nonio::aerotech
