// SPDX-License-Identifier: Apache-2.0
#include "consumer.h"

#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "nonio/sdk/units.h"

namespace nonio::siemens {
namespace {

// One line `$NAME[a,b,...]=value`.
struct Assignment {
  std::string name;
  std::vector<std::string> index;
  std::string value;
};

struct Table {
  std::map<std::size_t, double> entry;
  std::optional<double> min, max, step;
  bool modulo = false;
  double direction = 0.0;
  std::string input, output;
};

struct Memory {
  std::map<std::string, Table> encoder;  // "0,AX1"
  std::map<std::string, Table> cec;      // table number
  std::map<std::string, double> backlash;
};

std::string trimmed(std::string_view s) {
  const std::size_t a = s.find_first_not_of(" \t\r");
  if (a == std::string_view::npos) return {};
  return std::string(s.substr(a, s.find_last_not_of(" \t\r") - a + 1));
}

std::optional<double> real(const std::string& s) {
  double v = 0.0;
  const char* begin = s.data() + (!s.empty() && s[0] == '+' ? 1 : 0);
  const auto r = std::from_chars(begin, s.data() + s.size(), v);
  if (r.ec != std::errc() || r.ptr != s.data() + s.size() || !std::isfinite(v)) return {};
  return v;
}

// (AX1) or "AX1"
std::string axis_word(const std::string& s) {
  return s.size() > 2 ? s.substr(1, s.size() - 2) : std::string();
}

Expected<Assignment> assignment(const std::string& line) {
  const std::size_t open = line.find('['), close = line.find(']'), equals = line.find('=');
  if (line[0] != '$' || open == std::string::npos || close == std::string::npos ||
      equals == std::string::npos || !(open < close && close < equals))
    return fail("not an assignment: " + line);
  Assignment a{line.substr(1, open - 1), {}, trimmed(line.substr(equals + 1))};
  std::string rest = line.substr(open + 1, close - open - 1);
  for (std::size_t comma; (comma = rest.find(',')) != std::string::npos;
       rest = rest.substr(comma + 1))
    a.index.push_back(trimmed(rest.substr(0, comma)));
  a.index.push_back(trimmed(rest));
  return a;
}

Expected<void> put_parameter(Table& table, const std::string& what, const Assignment& a) {
  if (what == "INPUT_AXIS" || what == "OUTPUT_AXIS") {
    (what == "INPUT_AXIS" ? table.input : table.output) = axis_word(a.value);
    return {};
  }
  const auto v = real(a.value);
  if (!v) return fail("not a number: " + a.value);
  if (what == "STEP") {
    table.step = *v;
  } else if (what == "MIN") {
    table.min = *v;
  } else if (what == "MAX") {
    table.max = *v;
  } else if (what == "IS_MODULO") {
    table.modulo = *v != 0.0;
  } else if (what == "DIRECTION") {
    table.direction = *v;
  } else if (what == "MULT_BY_TABLE") {
    if (*v != 0.0) return fail("tables multiplied by others are not modelled");
  } else {
    return fail("unknown variable ..." + what);
  }
  return {};
}

Expected<void> put_entry(Table& table, const std::string& index, const Assignment& a,
                         std::size_t most) {
  const auto point = real(index), v = real(a.value);
  if (!point || *point < 0 || !v) return fail("not a number in " + a.name + " = " + a.value);
  if (*point >= static_cast<double>(most))
    return fail("alarm 12400: element " + index + " of " + a.name + " does not exist");
  table.entry[static_cast<std::size_t>(*point)] = *v;
  return {};
}

Expected<void> put(Memory& memory, const Assignment& a, const Machine& machine) {
  const std::string lec = "AA_ENC_COMP", cec = "AN_CEC";
  if (a.name == "MA_BACKLASH" && a.index.size() == 2) {
    const auto v = real(a.value);
    if (!v) return fail("not a number: " + a.value);
    memory.backlash[a.index[0] + "," + a.index[1]] = *v;
    return {};
  }
  if (a.name == lec && a.index.size() == 3)
    return put_entry(memory.encoder[a.index[0] + "," + a.index[2]], a.index[1], a,
                     machine.encoder_points);
  if (a.name == cec && a.index.size() == 2)
    return put_entry(memory.cec[a.index[0]], a.index[1], a, machine.cec_points);
  if (a.name.rfind(lec + "_", 0) == 0 && a.index.size() == 2)
    return put_parameter(memory.encoder[a.index[0] + "," + a.index[1]],
                         a.name.substr(lec.size() + 1), a);
  if (a.name.rfind(cec + "_", 0) == 0 && a.index.size() == 1)
    return put_parameter(memory.cec[a.index[0]], a.name.substr(cec.size() + 1), a);
  return fail("unknown variable " + a.name);
}

Expected<void> read_file(Memory& memory, std::string_view bytes, const Machine& machine) {
  bool begun = false, ended = false;
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string line = trimmed(bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    line = trimmed(line.substr(0, line.find(';')));
    if (line.empty()) continue;
    if (ended) return fail("text after M17: " + line);
    if (line[0] == '%') continue;
    if (line == "CHANDATA(1)") {
      begun = true;
    } else if (line == "M17") {
      ended = true;
    } else {
      if (!begun) return fail("assignment before CHANDATA: " + line);
      auto a = assignment(line);
      if (!a) return tl::unexpected<Error>(a.error());
      if (auto done = put(memory, *a, machine); !done) return done;
    }
  }
  return ended ? Expected<void>{} : fail("no M17 at the end");
}

Expected<void> whole(const Table& t) {
  if (!t.min || !t.max || !t.step || !(*t.step > 0.0) || !(*t.max > *t.min))
    return fail("MIN, MAX and STEP do not make a table");
  const double points = (*t.max - *t.min) / *t.step + 1.0;
  const auto n = static_cast<std::size_t>(std::llround(points));
  if (std::fabs(points - static_cast<double>(n)) > 1e-3)
    return fail("STEP does not divide MAX - MIN");
  if (t.entry.size() != n || t.entry.rbegin()->first != n - 1)
    return fail("the table has " + std::to_string(t.entry.size()) + " entries, its range " +
                std::to_string(n));
  if (t.modulo && t.entry.begin()->second != t.entry.rbegin()->second)
    return fail("a modulo table whose ends differ jumps once a turn");
  return {};
}

// Linear between the points; the end entries hold outside.
double interpolated(const Table& t, double x) {
  if (t.modulo) {
    const double period = *t.max - *t.min;
    x = *t.min + std::fmod(std::fmod(x - *t.min, period) + period, period);
  }
  if (x <= *t.min) return t.entry.begin()->second;
  if (x >= *t.max) return t.entry.rbegin()->second;
  const double k = (x - *t.min) / *t.step;
  const auto i = std::min(static_cast<std::size_t>(k), t.entry.size() - 2);
  const double a = t.entry.at(i), b = t.entry.at(i + 1);
  return a + (k - static_cast<double>(i)) * (b - a);
}

}  // namespace

Expected<math::Correction> load(const std::vector<std::string_view>& files,
                                const Machine& machine) {
  Memory memory;
  for (const std::string_view f : files)
    if (auto done = read_file(memory, f, machine); !done)
      return tl::unexpected<Error>(done.error());
  const std::string mine = std::to_string(machine.measuring_system) + "," + machine.axis;
  std::vector<Table> active;
  double backlash = machine.backlash;
  if (const auto it = memory.encoder.find(mine); it != memory.encoder.end())
    active.push_back(it->second);
  for (const auto& [number, table] : memory.cec)
    if (table.input == machine.axis && table.output == machine.axis) active.push_back(table);
  if (const auto it = memory.backlash.find(mine); it != memory.backlash.end())
    backlash = it->second;
  for (const Table& t : active)
    if (auto ok = whole(t); !ok) return tl::unexpected<Error>(ok.error());

  const double per_si = machine.rotary ? deg_per_rad : 1e3;
  // An entry is added to the actual value: a positive one drives the axis towards minus. Of the
  // backlash value one half is counted in each direction; the control may shift both by a
  // constant, which no range of deviations contains.
  return math::Correction([active, backlash, per_si](double x, int direction) {
    double c = direction > 0 ? backlash / 2.0 : -backlash / 2.0;
    for (const Table& t : active)
      if (t.direction == 0.0 || t.direction * direction > 0.0) c -= interpolated(t, x * per_si);
    return c / per_si;
  });
}

Expected<math::Correction> load_cross(const std::vector<std::string_view>& files,
                                      const std::string& input, const std::string& output,
                                      const Machine& machine) {
  Memory memory;
  for (const std::string_view f : files)
    if (auto done = read_file(memory, f, machine); !done)
      return tl::unexpected<Error>(done.error());
  std::vector<Table> active;
  for (const auto& [number, table] : memory.cec)
    if (table.input == input && table.output == output) active.push_back(table);
  if (active.empty()) return fail("no table with input " + input + " and output " + output);
  for (const Table& t : active)
    if (auto ok = whole(t); !ok) return tl::unexpected<Error>(ok.error());
  return math::Correction([active](double x, int direction) {
    double c = 0.0;
    for (const Table& t : active)
      if (t.direction == 0.0 || t.direction * direction > 0.0) c -= interpolated(t, x * 1e3);
    return c / 1e3;
  });
}

}  // namespace nonio::siemens
