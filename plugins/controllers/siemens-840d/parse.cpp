// SPDX-License-Identifier: Apache-2.0
#include "parse.h"

#include <cmath>
#include <map>
#include <optional>

#include "nonio/controllers/axes.h"
#include "nonio/controllers/text.h"
#include "nonio/math/loaded_table.h"

namespace nonio::siemens_840d {
namespace {

using controllers::KnownAxis;
using controllers::real;
using controllers::trimmed;

// `$NAME[a,b,...]=value`
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

constexpr std::int64_t most_elements = 5000;  // limit of MD38000 (manual K3)

struct Memory {
  std::size_t points = 0;
  std::map<std::string, Table> encoder;
  std::map<std::string, Table> cec;
  std::map<std::string, double> backlash;
};

std::string axis_word(const std::string& s) {
  return s.size() > 2 ? s.substr(1, s.size() - 2) : std::string();
}

Expected<Assignment> assignment(std::string_view line) {
  const std::size_t open = line.find('['), close = line.find(']'), equals = line.find('=');
  if (line.starts_with("$MN_") && open == std::string::npos && equals != std::string::npos)
    return Assignment{std::string(trimmed(line.substr(1, equals - 1))),
                      {},
                      std::string(trimmed(line.substr(equals + 1)))};
  if (line[0] != '$' || open == std::string::npos || close == std::string::npos ||
      equals == std::string::npos || !(open < close && close < equals))
    return fail("expected an assignment such as $AA_ENC_COMP[0,0,AX1]=0.001, found \"" +
                std::string(line) + "\"");
  Assignment a{
      std::string(line.substr(1, open - 1)), {}, std::string(trimmed(line.substr(equals + 1)))};
  for (const auto word : controllers::words_of(line.substr(open + 1, close - open - 1), ", \t"))
    a.index.emplace_back(word);
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
    if (*v != 0.0 && *v != 1.0) return fail("IS_MODULO is 0 or 1 in the control, found " + a.value);
    table.modulo = *v != 0.0;
  } else if (what == "DIRECTION") {
    if (*v != -1.0 && *v != 0.0 && *v != 1.0)
      return fail("DIRECTION is -1, 0 or 1 in the control, found " + a.value);
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
  const auto point = controllers::whole(index);
  const auto v = real(a.value);
  if (!point || *point < 0 || !v) return fail("not a number in " + a.name + " = " + a.value);
  if (most > 0 && *point >= static_cast<std::int64_t>(most))
    return fail("alarm 12400: element " + index + " of " + a.name +
                " does not exist: option max_points (MD38000, MD18342 of the control) is " +
                std::to_string(most));
  if (*point >= most_elements)
    return fail("element " + index + " of " + a.name + ": no control has more than " +
                std::to_string(most_elements));
  table.entry[static_cast<std::size_t>(*point)] = *v;
  return {};
}

/// MD10240 of the control and MD32711 of an axis must be 1 (metric).
Expected<void> put_unit(const Assignment& a) {
  const auto v = real(a.value);
  if (v && *v == 1.0) return {};
  return fail("$" + a.name + " = " + a.value +
              ": the tables of this backup are in inch; only tables in mm are read and written: "
              "save the backup from a control that is set to metric ($" +
              a.name + " = 1)");
}

Expected<void> put(Memory& memory, const Assignment& a) {
  if (a.name == "MN_SCALING_SYSTEM_IS_METRIC" || a.name == "MA_CEC_SCALING_SYSTEM_METRIC")
    return put_unit(a);
  const std::string lec = "AA_ENC_COMP", cec = "AN_CEC";
  if (a.name == "MA_BACKLASH" && a.index.size() == 2) {
    const auto v = real(a.value);
    if (!v) return fail("not a number: " + a.value);
    memory.backlash[a.index[0] + "," + a.index[1]] = *v;
    return {};
  }
  if (a.name == lec && a.index.size() == 3)
    return put_entry(memory.encoder[a.index[0] + "," + a.index[2]], a.index[1], a, memory.points);
  if (a.name == cec && a.index.size() == 2)
    return put_entry(memory.cec[a.index[0]], a.index[1], a, memory.points);
  if (a.name.rfind(lec + "_", 0) == 0 && a.index.size() == 2)
    return put_parameter(memory.encoder[a.index[0] + "," + a.index[1]],
                         a.name.substr(lec.size() + 1), a);
  if (a.name.rfind(cec + "_", 0) == 0 && a.index.size() == 1)
    return put_parameter(memory.cec[a.index[0]], a.name.substr(cec.size() + 1), a);
  return fail("unknown variable " + a.name);
}

/// Reads an archive (%_N_, CHANDATA(1), assignments, M17) or a part program, which contains only
/// assignments and ends with M17, M2 or M30.
Expected<void> read_file(Memory& memory, const Artifact& file) {
  bool any = false, archive = false, begun = false, ended = false;
  std::size_t number = 0;
  const auto wrong = [&](const std::string& message) -> Expected<void> {
    if (!any) return fail(message);
    return controllers::fail_at(file.name, number, message);
  };
  for (std::string_view line : controllers::lines_of(file.bytes)) {
    ++number;
    line = trimmed(line.substr(0, line.find(';')));
    if (line.empty()) continue;
    if (ended) return wrong("text after the end of the program: " + std::string(line));
    if (line[0] == '%') {
      archive = true;
    } else if (line == "CHANDATA(1)") {
      archive = begun = true;
    } else if (line == "M17" || (!archive && (line == "M2" || line == "M02" || line == "M30"))) {
      ended = true;
    } else if (!archive && (line == "M0" || line == "M00")) {
      continue;  // M0 stops the program and changes nothing
    } else {
      if (archive && !begun) return wrong("assignment before CHANDATA: " + std::string(line));
      auto a = assignment(line);
      if (!a) return wrong(a.error().message);
      any = any || a->name.starts_with("A");
      if (auto done = put(memory, *a); !done) return wrong(done.error().message);
    }
  }
  return ended ? Expected<void>{} : wrong("no M17 at the end");
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
  return {};
}

// A positive entry is added to the actual value, so it drives the output axis towards minus.
Expected<LoadedTable> loaded(const Table& t, const KnownAxis& input, const KnownAxis& output) {
  if (auto ok = whole(t); !ok) return tl::unexpected<Error>(ok.error());
  using Outside = LoadedTable::Outside;
  LoadedTable out{.output = output.name,
                  .input = {input.name},
                  .position = {{}},
                  .plus = {},
                  .minus = {},
                  .outside = t.modulo ? Outside::repeats : Outside::holds,
                  .rotary = output.rotary};
  std::vector<double> c;
  for (const auto& [i, entry] : t.entry) {
    out.position[0].push_back((*t.min + *t.step * static_cast<double>(i)) / input.per_si());
    c.push_back(-entry / output.per_si());
  }
  const std::vector<double> nothing(c.size(), 0.0);
  out.plus = t.direction < 0.0 ? nothing : c;
  if (t.direction != 0.0) out.minus = t.direction < 0.0 ? c : nothing;
  if (auto ok = math::validate_table(out); !ok) return tl::unexpected<Error>(ok.error());
  return out;
}

KnownAxis axis_of(const std::vector<KnownAxis>& axes, const std::string& word) {
  const auto number = word.rfind("AX", 0) == 0 ? controllers::whole(word.substr(2)) : std::nullopt;
  KnownAxis axis = number && *number > 0 ? axis_numbered(axes, static_cast<std::size_t>(*number))
                                         : axis_named(axes, word);
  if (axis.settings.empty() && controllers::whole(axis.name)) axis.name = word;
  return axis;
}

}  // namespace

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  NONIO_TRY(const auto axes, controllers::known_axes(in));
  Memory memory;
  // The default is the limit of the smallest control, so it is not applied to files of larger ones.
  constexpr std::int64_t fewest = 200;
  if (const auto points = in.options.integer("max_points", fewest); points != fewest)
    memory.points = static_cast<std::size_t>(points);
  for (const Artifact& f : in.files)
    if (auto done = read_file(memory, f); !done) return tl::unexpected<Error>(done.error());
  std::vector<LoadedTable> tables;
  const auto add = [&](Expected<LoadedTable> t) -> Expected<void> {
    if (!t) return controllers::fail_at(in.files.front().name, 1, t.error().message);
    tables.push_back(std::move(*t));
    return {};
  };
  const std::string system = std::to_string(in.options.integer("measuring_system")) + ",";
  for (const auto& [index, table] : memory.encoder) {
    if (index.rfind(system, 0) != 0) continue;
    const KnownAxis axis = axis_of(axes, index.substr(system.size()));
    if (auto done = add(loaded(table, axis, axis)); !done)
      return tl::unexpected<Error>(done.error());
    if (const auto lost = memory.backlash.find(index); lost != memory.backlash.end())
      tables.back().backlash = lost->second / axis.per_si();
  }
  for (const auto& [number, table] : memory.cec)
    if (auto done = add(loaded(table, axis_of(axes, table.input), axis_of(axes, table.output)));
        !done)
      return tl::unexpected<Error>(done.error());
  return tables;
}

}  // namespace nonio::siemens_840d
