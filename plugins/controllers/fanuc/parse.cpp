// SPDX-License-Identifier: Apache-2.0
#include "parse.h"

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>

#include "nonio/controllers/axes.h"
#include "nonio/controllers/text.h"
#include "nonio/math/loaded_table.h"

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

}  // namespace

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  const auto axes = controllers::known_axes(in);
  if (!axes) return tl::unexpected<Error>(axes.error());
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
    const auto axis = axis_numbered(*axes, static_cast<std::size_t>(number));
    const bool plus = o.text("reference_return") != "-";
    const Units units = axis.rotary
                            ? Units{o.number("detection_unit_arcsec", 3.6) / arcsec_per_rad,
                                    o.number("interval_unit_arcsec", 3.6) / arcsec_per_rad, plus}
                            : Units{o.number("detection_unit_um", 1.0) * 1e-6,
                                    o.number("interval_unit_um", 1.0) * 1e-6, plus};
    auto read = table(memory, parameters, axis, units);
    if (!read) return tl::unexpected<Error>(read.error());
    tables.push_back(std::move(*read));
  }
  if (tables.empty()) return fail("no parameters 3620 to 3624");
  return tables;
}

}  // namespace nonio::fanuc
