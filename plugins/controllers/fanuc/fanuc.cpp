// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "merge.h"
#include "nonio/controllers/axes.h"
#include "nonio/controllers/kit.h"
#include "nonio/controllers/text.h"
#include "nonio/math/loaded_table.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/plugin.h"

namespace nonio::fanuc {

namespace {

using ParameterValues = std::map<std::int64_t, std::int64_t>;

struct Memory {
  std::map<std::int64_t, ParameterValues> parameter;
  std::map<std::int64_t, std::int64_t> pitch;
  std::int64_t least = -7, most = 7;  // permitted range of a compensation value
};

Expected<void> put(Memory& memory, std::int64_t number, std::int64_t axis, std::int64_t value,
                   const std::string& whole_line) {
  constexpr std::int64_t word = 1000000000;
  if (number < 0 || number > word || std::abs(value) > word || std::abs(axis) > word)
    return fail("not a block: " + whole_line);
  if (number < 10000) {
    memory.parameter[axis][number] = value;
    return {};
  }
  if (axis != 0) return fail("pitch data do not belong to an axis: " + whole_line);
  if (value < memory.least || value > memory.most) return fail("out of range: " + whole_line);
  if (!memory.pitch.emplace(number - 10000, value).second)
    return fail("point given twice: " + whole_line);
  return {};
}

// Block formats, one per line: N<number>P<value>, or N<number>A<axis>P<value>A<axis>P<value>. Newer
// controls (30i, 31i, 0i-F) write Q0 (pitch data) or Q1 (parameters) after the number.
Expected<void> block(Memory& memory, std::string_view line) {
  std::int64_t number = -1, axis = 0;
  bool has_value = false;
  const auto whole_line = std::string(line);
  while (!line.empty()) {
    const char letter = line.front();
    std::int64_t n = 0;
    const auto r = std::from_chars(line.data() + 1, line.data() + line.size(), n);
    const bool is_kind = letter == 'Q' && (n == 0 || n == 1);
    if (r.ec != std::errc() || (letter != 'N' && letter != 'A' && letter != 'P' && !is_kind))
      return fail("not a block: " + whole_line);
    if (letter == 'N') number = n;
    if (letter == 'A') axis = n;
    line.remove_prefix(static_cast<std::size_t>(r.ptr - line.data()));
    if (letter != 'P') continue;
    has_value = true;
    if (auto ok = put(memory, number, axis, n, whole_line); !ok) return ok;
  }
  return has_value ? Expected<void>{} : fail("not a block: " + whole_line);
}
Expected<void> punched(Memory& memory, std::string_view text) {
  int percents = 0;
  for (std::string_view line : controllers::lines_of(text)) {
    while (!line.empty() && line.back() == ';') line.remove_suffix(1);
    if (line.empty()) continue;
    if (line == "%") {
      ++percents;
    } else if (percents != 1) {
      return fail("a block outside of the two %");
    } else if (auto ok = block(memory, line); !ok) {
      return ok;
    }
  }
  return percents == 2 ? Expected<void>{} : fail("not enclosed by %");
}

// Absolute compensation in pulses at the ends of the intervals, 0 at the reference position. Point
// n contains the change over the interval that ends (n - reference) intervals from this position.
Expected<std::vector<double>> staircase(const Memory& m, const ParameterValues& p,
                                        std::int64_t offset) {
  std::vector<double> value{0.0};
  double sum = 0.0, at_reference = 0.0;
  for (std::int64_t n = p.at(3621); n <= p.at(3622); ++n) {
    const auto it = m.pitch.find(n + offset);
    if (it == m.pitch.end()) return fail("no data for point " + std::to_string(n + offset));
    sum += static_cast<double>(it->second);
    value.push_back(sum);
    if (n == p.at(3620)) at_reference = sum;
  }
  for (double& v : value) v -= at_reference;
  return value;
}

bool closed(const std::vector<double>& s) {
  const std::size_t n = s.size();
  return n > 2 && s[n - 1] == s[1] && s[n - 2] == s[0];
}

struct Units {
  double detection, interval;  // m or rad
  bool returns_towards_plus;
};

Expected<LoadedTable> table(const Memory& m, const ParameterValues& p,
                            const controllers::KnownAxis& axis, const Units& unit) {
  for (const std::int64_t n : {3620, 3621, 3622, 3623, 3624})
    if (p.count(n) == 0) return fail("no parameter " + std::to_string(n));
  if (p.at(3621) > p.at(3620) || p.at(3620) >= p.at(3622) || p.at(3624) <= 0 || p.at(3623) < 1 ||
      p.at(3623) > 100 || p.at(3622) - p.at(3621) > 10000)
    return fail("3620 to 3624 do not make a table");
  const bool turn = axis.rotary && p.count(3625) != 0;
  if (turn &&
      std::fabs(static_cast<double>(p.at(3625)) * unit.interval - 2.0 * std::numbers::pi) > 1e-9)
    return fail("3625 is not a turn");
  auto plus = staircase(m, p, 0);
  if (!plus) return tl::unexpected<Error>(plus.error());
  auto minus = plus;
  // 3605#0 selects two value sets. Without 3605 (not a whole backup), 3626 decides.
  const auto bits = p.find(3605);
  const bool directions = bits == p.end() ? p.count(3626) != 0 : bits->second % 10 == 1;
  if (directions) {
    if (p.count(3626) == 0) return fail("no parameter 3626");
    if (p.count(3627) == 0) return fail("no parameter 3627");
    minus = staircase(m, p, p.at(3626) - p.at(3621));
    if (!minus) return tl::unexpected<Error>(minus.error());
    const auto shift = static_cast<double>(p.at(3627));
    for (double& v : unit.returns_towards_plus ? *minus : *plus) v += shift;
  }
  if (turn && !(closed(*plus) && closed(*minus)))
    return fail("the increments of a turn do not close it");

  LoadedTable out{.output = axis.name,
                  .input = {axis.name},
                  .position = {{}},
                  .plus = {},
                  .minus = {},
                  .outside = turn ? LoadedTable::Outside::repeats : LoadedTable::Outside::holds,
                  .rotary = axis.rotary};
  const double pulse = static_cast<double>(p.at(3623)) * unit.detection;
  const double step = static_cast<double>(p.at(3624)) * unit.interval;
  const double first = turn ? 0.0 : axis.position_setting("reference").value_or(0.0);
  // The first value of a whole revolution repeats the last one, so it is skipped.
  for (std::size_t i = turn ? 1 : 0; i < plus->size(); ++i) {
    const double at = static_cast<double>(p.at(3621) - 1 - p.at(3620)) + static_cast<double>(i);
    out.position[0].push_back(first + at * step);
    out.plus.push_back((*plus)[i] * pulse);
    if (directions) out.minus.push_back((*minus)[i] * pulse);
  }
  if (const auto lost = p.find(1851); lost != p.end())
    out.backlash = static_cast<double>(lost->second) * unit.detection;
  if (auto ok = math::validate_table(out); !ok) return tl::unexpected<Error>(ok.error());
  return out;
}

/// Parameter 1001#0 (INM) is 1 on machines in inch; the options must then state the units.
Expected<void> check_units(const Memory& m, const Settings& o) {
  const auto common = m.parameter.find(0);
  if (common == m.parameter.end()) return {};
  const auto bits = common->second.find(1001);
  if (bits == common->second.end() || bits->second % 10 != 1) return {};
  if (o.number("detection_unit_um", 1.0) != 1.0 && o.number("interval_unit_um", 1.0) != 1.0)
    return {};
  return fail(
      "parameter 1001#0 (INM) is 1, so the machine works in inch: state detection_unit_um and "
      "interval_unit_um under [options.fanuc], 2.54 if the least increment is 0.0001 inch");
}

/// A backup contains the parameters of all axes; they are 0 without a table.
bool has_table(const ParameterValues& p) {
  const auto interval = p.find(3624);
  return interval != p.end() ? interval->second != 0 : p.count(3620) != 0;
}

/// Follows the manual of the control, independently of the code that writes the files, so that it
/// verifies them.
Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  NONIO_TRY(const auto axes, controllers::known_axes(in));
  const Settings& o = in.options;
  Memory memory;
  if (o.flag("extended")) memory.least = -128, memory.most = 127;
  bool any = false;
  for (const Artifact& f : in.files) {
    if (f.bytes.rfind('%', 0) != 0) continue;
    any = true;
    if (auto done = punched(memory, f.bytes); !done) return tl::unexpected<Error>(done.error());
  }
  if (!any) return fail("not a punched text: it does not begin with %");
  if (auto fits = check_units(memory, o); !fits) return tl::unexpected<Error>(fits.error());
  std::vector<LoadedTable> tables;
  for (const auto& [number, parameters] : memory.parameter) {
    if (!has_table(parameters)) continue;
    const auto axis = axis_numbered(axes, static_cast<std::size_t>(number));
    const bool plus = o.text("reference_return") != "-";
    const Units units = axis.rotary
                            ? Units{o.number("detection_unit_arcsec", 3.6) / arcsec_per_rad,
                                    o.number("interval_unit_arcsec", 3.6) / arcsec_per_rad, plus}
                            : Units{o.number("detection_unit_um", 1.0) * 1e-6,
                                    o.number("interval_unit_um", 1.0) * 1e-6, plus};
    NONIO_TRY(auto read, table(memory, parameters, axis, units));
    tables.push_back(std::move(read));
  }
  if (tables.empty()) return fail("no parameters 3620 to 3624");
  return tables;
}

using controllers::AxisJob;
using controllers::Sheet;
using Confidence = ControlTable::Confidence;
using Integers = std::vector<std::int64_t>;

ControlTable declared() {
  ControlTable t;
  t.name = "3620 to 3627";
  t.sign = ControlTable::Sign::correction;
  t.entry = ControlTable::Entry::increment;
  t.zero = ControlTable::Zero::reference;
  t.position_unit = t.position_step = {1e-6, 3.6 / arcsec_per_rad};
  t.value_unit = t.value_step = {1e-6, 3.6 / arcsec_per_rad};
  t.points = 128;
  t.increment = {-7, 7};
  t.bidirectional = true;
  t.backlash = "1851";
  t.facts = {
      {"sign", Confidence::inferred, "Inferred: the sign of the pitch data, -(e(n) - e(n-1))."},
      {"form", Confidence::unsure,
       "Unsure: the form of the file (N10000 + point, axis word A); compare it with a "
       "backup of the control before loading."},
      {"negative", Confidence::unsure,
       "Unsure: numbers of the negative direction at N13000 (option negative_numbers); 3627 "
       "in pulses times magnification."}};
  return t;
}

ControlTable table_of(const Settings& o) {
  ControlTable t = *controllers::chosen(declared(), o);
  const double m = static_cast<double>(o.integer("magnification", 1));
  t.position_unit = {o.number("interval_unit_um") * 1e-6,
                     o.number("interval_unit_arcsec") / arcsec_per_rad};
  t.value_unit = {m * o.number("detection_unit_um") * 1e-6,
                  m * o.number("detection_unit_arcsec") / arcsec_per_rad};
  t.position_step = t.position_unit;
  t.value_step = t.value_unit;
  if (o.flag("extended")) t.increment = {-128, 127};
  if (!o.flag("directions")) t.facts.pop_back();
  return t;
}

// Parameters of one axis without its compensation values; comments are parameter numbers.
struct Parameters {
  std::int64_t reference = 0, low = 0, high = 0;  // 3620, 3621, 3622
  std::int64_t magnification = 1;                 // 3623
  std::int64_t interval = 0, turn = 0;            // 3624; 3625, 0 unless rotary over a revolution
  std::int64_t negative_low = 0, opposite = 0;    // 3626, 3627
  std::int64_t backlash = 0;                      // 1851
};

// In a table of a whole revolution, the first value (at the reference position) repeats the last.
Integers numbers_of(Integers steps, bool turn) {
  if (turn) steps.insert(steps.begin(), steps.back());
  return steps;
}

Expected<Parameters> parameters_of(const Sheet& s) {
  const Settings& o = s.input.options;
  Parameters p;
  p.magnification = o.integer("magnification", 1);
  const double detection = s.value_unit() / static_cast<double>(p.magnification);
  p.interval = std::llround(s.grid.step / s.position_unit());
  if (s.job.turn) p.turn = p.interval * static_cast<std::int64_t>(s.grid.points - 1);
  p.backlash = std::llround(s.backlash() / detection);
  if (std::abs(p.backlash) > 9999)
    return fail("axis " + s.job.axis + ": parameter 1851 would be " + std::to_string(p.backlash) +
                ", the control takes -9999..9999: set a larger detection_unit_um");
  // 3627 applies to the direction opposite to the reference return.
  p.opposite = (o.text("reference_return", "+") != "-" ? 1 : -1) * s.minus_start();
  return p;
}

// All axes share one list of point numbers; each axis gets the next free range unless its
// reference_number is stated.
struct Numbering {
  std::int64_t next = 0;
  struct Range {
    std::string axis;
    std::int64_t low, high;
    bool chosen = false;
  };
  std::vector<Range> taken{};

  static std::int64_t free_from(std::int64_t low, std::int64_t above, const Settings& o) {
    const auto used = controllers::ranges_of(o.texts("taken"));
    for (std::size_t i = 0; i < used.size();)
      if (used[i].first <= low + above && low <= used[i].second)
        low = used[i].second + 1, i = 0;
      else
        ++i;
    return low;
  }

  Expected<void> place(const Sheet& s, Parameters& p) {
    const Settings& o = s.input.options;
    const auto intervals = static_cast<std::int64_t>(s.plus_steps.size());
    const std::int64_t before =
        p.turn != 0 ? 0 : std::llround((s.reference - s.grid.first) / s.grid.step) - 1;
    const auto asked = s.job.setting("reference_number");
    const std::int64_t all = o.integer("reference_number", -1);
    const std::int64_t reference = asked ? std::llround(*asked) : all;
    const std::int64_t above = intervals - (p.turn != 0 ? 0 : 1);
    p.low = asked || all >= 0 ? reference - before : free_from(next, above, o);
    p.reference = p.low + before;
    p.high = p.low + above;
    p.negative_low = o.integer("negative_numbers", 3000) + p.low;
    const std::int64_t last = o.integer("last_number", 1023);
    if (p.low < 0 || p.high > last)
      return fail("axis " + s.job.axis + ": numbers " + std::to_string(p.low) + " to " +
                  std::to_string(p.high) + " are not all in 0.." + std::to_string(last) +
                  ": set another reference_number or a larger step");
    for (const Range& r : taken)
      if (r.axis != s.job.axis && p.low <= r.high && r.low <= p.high)
        return fail("axes " + r.axis + " and " + s.job.axis + " would share numbers " +
                    std::to_string(std::max(r.low, p.low)) + " to " +
                    std::to_string(std::min(r.high, p.high)) +
                    ": set reference_number = ... under [options.fanuc.axes." + s.job.axis + "]");
    taken.push_back({s.job.axis, p.low, p.high, !asked && all < 0});
    next = std::max(next, p.high + 1);
    return {};
  }
};

// Writes complete parameter words only, because 3605 contains other bits of the machine builder.
std::string parameter_text(const Sheet& s, const Parameters& p) {
  std::string out = "%\n";
  const auto parameter = [&](int number, std::int64_t value) {
    out += "N" + std::to_string(number) + "A" + std::to_string(s.job.number) + "P" +
           std::to_string(value) + "\n";
  };
  if (s.job.curve.bidirectional()) parameter(1851, p.backlash);
  parameter(3620, p.reference);
  parameter(3621, p.low);
  parameter(3622, p.high);
  parameter(3623, p.magnification);
  parameter(3624, p.interval);
  if (p.turn != 0) parameter(3625, p.turn);
  if (s.directions) {
    parameter(3626, p.negative_low);
    parameter(3627, p.opposite);
  }
  const auto data = [&](std::int64_t first, const Integers& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      out += "N" + std::to_string(10000 + first + static_cast<std::int64_t>(i)) + "P" +
             std::to_string(values[i]) + "\n";
  };
  data(p.low, numbers_of(s.plus_steps, p.turn != 0));
  if (s.directions) data(p.negative_low, numbers_of(s.minus_steps, p.turn != 0));
  return out + "%\n";
}

std::string words(const Sheet& s, const Parameters& p) {
  const AxisJob& job = s.job;
  const Settings& o = s.input.options;
  std::vector<std::string> lines = s.warning;
  lines.insert(lines.end(), job.about.begin(), job.about.end());
  const auto line = [&](const std::string& text) { lines.push_back(text); };
  const auto is = [](int n, std::int64_t v) {
    return std::to_string(n) + " = " + std::to_string(v);
  };
  line(
      "sign: numbers are changes of the compensation, the opposite of the measured deviation "
      "(actual - nominal), read in the direction of plus");
  line("unit of a number: " + std::to_string(p.magnification) + " x " +
       short_text(o.number(job.rotary ? "detection_unit_arcsec" : "detection_unit_um"), 4) +
       (job.rotary ? " arcsec" : " um"));
  line(controllers::reversal_words(job, s.columns()));
  for (const std::string& zero : s.zero_and_size()) line(zero);
  line("controlled axis number " + std::to_string(job.number) + "; reference position at " +
       controllers::with_unit(job, s.reference, 4));
  line(std::string("3605#0 (both directions) = ") + (s.directions ? "1" : "0") +
       ", by hand: the other bits of 3605 belong to the builder of the machine");
  line(job.setting("reference_number") || o.integer("reference_number", -1) >= 0
           ? "numbers " + std::to_string(p.low) + " to " + std::to_string(p.high) + ", as asked for"
           : "CHOSEN, not read from a backup: numbers " + std::to_string(p.low) + " to " +
                 std::to_string(p.high) +
                 "; where another axis has them, load a file of nonio table insert instead");
  line(is(3620, p.reference) + ", " + is(3621, p.low) + ", " + is(3622, p.high) + ", " +
       is(3623, p.magnification) + ", " + is(3624, p.interval));
  if (p.turn != 0) line(is(3625, p.turn) + ", type of axis: rotary");
  if (s.directions) line(is(3626, p.negative_low) + ", " + is(3627, p.opposite));
  if (job.curve.bidirectional())
    line(is(1851, p.backlash) + "; 1852 the same where rapid traverse has its own (1800#4)");
  line(
      "save the present parameters and pitch data first; power off and on after loading, then "
      "return to reference");
  return controllers::comments(lines, "");
}

Expected<OutputResult> write(const ControllerInput& input) {
  Numbering numbering;
  const Settings& o = input.options;
  controllers::Writer writer{
      .name = "fanuc",
      .table = table_of(o),
      .keys = {"number:", "reference_number:", "step", "reference", "backlash"},
      .files = [&](const Sheet& s) -> Expected<std::vector<Artifact>> {
        NONIO_TRY(auto p, parameters_of(s));
        if (auto placed = numbering.place(s, p); !placed)
          return tl::unexpected<Error>(placed.error());
        const std::string stem = "fanuc-" + s.job.stem;
        return std::vector<Artifact>{{stem + ".prm", parameter_text(s, p)},
                                     {stem + ".txt", words(s, p)}};
      },
      .parse = parse,
      .zero_of = o.text("reference_return", "+") != "-" ? controllers::ZeroOf::plus
                                                        : controllers::ZeroOf::minus,
      .backlash_in_steps = true,
      .coarser = {
          "magnification", o.integer("magnification", 1), 100,
          o.flag("extended") ? "" : ", or set extended = true if the control takes -128..127"}};
  auto result = controllers::write_tables(input, writer);
  for (const Numbering::Range& r : numbering.taken)
    if (result && r.chosen)
      result->notes.push_back(
          {"table.numbers-chosen",
           {},
           {{"axis", r.axis}, {"numbers", std::to_string(r.low) + "-" + std::to_string(r.high)}}});
  return result;
}

Option whole(std::string name, std::int64_t otherwise, std::string help, double least,
             double most) {
  return {std::move(name), otherwise, "", std::move(help), {}, least, most};
}

Option unit(std::string name, double otherwise, std::string in, std::string help) {
  return {std::move(name), otherwise, std::move(in), std::move(help), {}, 1e-4, 1e4};
}

std::vector<Option> options() {
  return controllers::table_options(
      declared(),
      "number (controlled axis), reference_number (3620), step_mm, reference_mm, backlash_mm (1851 "
      "while measured), and the same with _deg",
      {{"extended", false, "", "The control takes -128..127 in a number, not -7..7."},
       one_of({"+", "-"}, {"reference_return", std::string("+"), "",
                           "Direction in which the axis returns to reference."}),
       {"taken", std::vector<std::string>{}, "",
        "Numbers that are in use in the control, \"0\", \"100-227\": others are taken."},
       whole("magnification", 1, "Parameter 3623.", 1, 100),
       whole("reference_number", -1, "Parameter 3620; -1: the next free numbers are taken.", -1,
             1535),
       whole("negative_numbers", 3000,
             "Distance from a number of the plus direction to that of minus.", 1, 5000),
       whole("last_number", 1023, "Largest number of the control.", 3, 9999),
       unit("detection_unit_um", 1.0, "um", "Detection unit of linear axes."),
       unit("detection_unit_arcsec", 3.6, "arcsec", "Detection unit of rotary axes."),
       unit("interval_unit_um", 1.0, "um", "Unit of 3624 on linear axes."),
       unit("interval_unit_arcsec", 3.6, "arcsec", "Unit of 3624 and 3625 on rotary axes.")});
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"fanuc", "1.1.0",
       "Stored pitch error compensation (3620-3627) and backlash (1851) for FANUC.", options()},
      declared(), write, parse, controllers::Offered::always);
  controller.merge = merge;
  registry.add(std::move(controller));
}

}  // namespace nonio::fanuc
