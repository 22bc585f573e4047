// SPDX-License-Identifier: Apache-2.0
#include "parse.h"

#include <cmath>
#include <map>
#include <optional>

#include "nonio/controllers/axes.h"
#include "nonio/controllers/text.h"
#include "nonio/math/loaded_table.h"

namespace nonio::heidenhain_tnc {
namespace {

using controllers::KnownAxis;
using Lines = std::vector<std::string_view>;

// The word that begins in this column; the table editor uses only column positions.
std::string_view cell(std::string_view line, std::size_t column) {
  if (column == std::string_view::npos || column >= line.size()) return {};
  const std::string_view rest = line.substr(column);
  return rest.substr(0, std::min(rest.find(' '), rest.size()));
}

std::optional<double> real(std::string_view s) {
  if (s.empty() || (s[0] != '+' && s[0] != '-')) return {};  // a sign is mandatory
  return controllers::real(s);
}

std::size_t column_of(std::string_view head, std::string_view name) {
  for (std::size_t at = 0; (at = head.find(name, at)) != std::string_view::npos; ++at) {
    const bool begins = at == 0 || head[at - 1] == ' ';
    const bool ends = at + name.size() == head.size() || head[at + name.size()] == ' ';
    if (begins && ends) return at;
  }
  return std::string_view::npos;
}

std::optional<double> after(std::string_view line, std::string_view key) {
  const std::size_t at = line.find(key);
  return at == std::string_view::npos ? std::nullopt : real(cell(line, at + key.size()));
}

/// If line 1 has DATUM and DISTANCE, the rows must agree with them.
Expected<std::vector<double>> positions(const Lines& lines, std::size_t end) {
  const auto datum = after(lines[0], "DATUM:"), distance = after(lines[0], "DISTANCE:");
  if (datum.has_value() != distance.has_value() || (distance && !(*distance > 0.0)))
    return fail("no DATUM and DISTANCE in line 1");
  const std::size_t column = datum ? 8 : column_of(lines[1], "AXISPOS");
  std::vector<double> out;
  for (std::size_t i = 2; i < end; ++i) {
    const auto x = real(cell(lines[i], column));
    const double row = static_cast<double>(out.size());
    if (cell(lines[i], 0) != std::to_string(out.size()) || !x ||
        (datum && std::fabs(*x - (*datum + *distance * row)) > 1e-4))
      return fail("line " + std::to_string(i + 1) + " is not at its place");
    out.push_back(*x);
  }
  return out;
}

Expected<std::vector<double>> column(const Lines& lines, std::size_t end, std::string_view name) {
  std::vector<double> out;
  const std::size_t at = column_of(lines[1], name);
  for (std::size_t i = 2; i < end; ++i)
    if (const auto v = real(cell(lines[i], at))) out.push_back(*v);
  if (!out.empty() && out.size() != end - 2)
    return fail(std::string(name) + " is filled in some rows only");
  return out;
}

/// Entries are errors (+e), which the control subtracts.
LoadedTable table(const KnownAxis& input, const KnownAxis& output, const std::vector<double>& x,
                  const std::vector<double>& plus, const std::vector<double>& minus) {
  const bool turn = input.rotary && x.front() == 0.0 && x.back() == 360.0;
  LoadedTable t{.output = output.name,
                .input = {input.name},
                .position = {{}},
                .plus = {},
                .minus = {},
                .outside = turn ? LoadedTable::Outside::repeats : LoadedTable::Outside::holds,
                .rotary = output.rotary};
  for (const double v : x) t.position[0].push_back(v / input.per_si());
  for (const double v : plus) t.plus.push_back(0.0 - v / output.per_si());
  for (const double v : minus) t.minus.push_back(0.0 - v / output.per_si());
  return t;
}

using Owners = std::map<std::string, std::string, std::less<>>;

void note_owners(std::string_view cma, Owners& owners) {
  const Lines lines = controllers::lines_of(cma);
  if (lines.size() < 2) return;
  for (const std::string_view name : controllers::words_of(lines[1])) {
    if (name == "NR" || name == "ACTIVE") continue;
    for (std::size_t i = 2; i < lines.size(); ++i)
      if (const auto table = cell(lines[i], column_of(lines[1], name)); !table.empty())
        owners.emplace(table, name);
  }
}

Expected<std::vector<LoadedTable>> com(std::string_view bytes, const std::vector<KnownAxis>& axes,
                                       std::size_t most, const Owners& owners) {
  const Lines lines = controllers::lines_of(bytes);
  if (lines.size() < 4) return fail("not a .COM table");
  if (column_of(lines[0], "INCH") != std::string_view::npos)
    return fail("line 1 states INCH: " + std::string(lines[0].substr(0, 60)) +
                "; only tables in mm are read: save it from a control that is set to mm");
  const bool with_datum = lines[0].find("DATUM:") != std::string_view::npos;
  std::size_t end = lines.size();
  while (!with_datum && end > 2 && lines[end - 1] != "[END]") --end;
  if (!with_datum && --end < 3) return fail("no [END]");
  const auto x = positions(lines, end);
  if (!x) return tl::unexpected<Error>(x.error());
  if (x->size() < 2 || x->size() > most)
    return fail(std::to_string(x->size()) + " rows, the control takes 2 to " +
                std::to_string(most));
  const auto name_of_table = cell(lines[0], 6);
  const auto owner = owners.find(name_of_table);
  const KnownAxis input = owner != owners.end()
                              ? axis_named(axes, owner->second)
                              : axis_of_file(axes, name_of_table, name_of_table.substr(0, 5));
  const auto negative = column(lines, end, "BACKLASH");
  if (!negative) return tl::unexpected<Error>(negative.error());
  std::vector<LoadedTable> tables;
  for (const auto name : controllers::words_of(lines[1])) {
    if (name == "NR" || name == "AXISPOS" || name == "BACKLASH") continue;
    const auto values = column(lines, end, name);
    if (!values) return tl::unexpected<Error>(values.error());
    if (values->empty()) continue;
    const KnownAxis output = axis_named(axes, name);
    const bool own = output.name == input.name;
    tables.push_back(table(input, output, *x, *values, own ? *negative : std::vector<double>{}));
    if (auto ok = math::validate_table(tables.back()); !ok)
      return tl::unexpected<Error>(ok.error());
  }
  return tables;
}

}  // namespace

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  const auto axes = controllers::known_axes(in);
  if (!axes) return tl::unexpected<Error>(axes.error());
  std::vector<LoadedTable> tables;
  std::map<std::string, double> backlash;
  const auto most = static_cast<std::size_t>(in.options.integer("max_points", 256));
  Owners owners;
  for (const Artifact& f : in.files)
    if (f.bytes.rfind("BEGIN CONFIG.CMA", 0) == 0) note_owners(f.bytes, owners);
  for (const Artifact& f : in.files) {
    if (auto ended = controllers::ends_whole(f.name, f.bytes); !ended)
      return tl::unexpected<Error>(ended.error());
    const Lines lines = controllers::lines_of(f.bytes);
    const bool is_table = !lines.empty() && lines[0].rfind("BEGIN ", 0) == 0;
    if (is_table && lines[0].rfind("BEGIN CONFIG.CMA", 0) == 0) continue;
    for (const std::string_view line : lines)
      if (const auto v = after(line, "backLash = "); v && !is_table)
        backlash[f.name.empty() ? "" : axis_of_file(*axes, f.name, "heidenhain-tnc-").name] = *v;
    if (!is_table && in.files.size() == 1) return fail("not a .COM table");
    if (!is_table) continue;
    auto read = com(f.bytes, *axes, most, owners);
    if (!read) return read;
    tables.insert(tables.end(), read->begin(), read->end());
  }
  for (LoadedTable& t : tables) {
    auto it = backlash.find(t.output);
    if (it == backlash.end()) it = backlash.find("");
    if (t.output == t.input.front() && it != backlash.end())
      t.backlash = it->second / (t.rotary ? deg_per_rad : 1e3);
  }
  return tables;
}

}  // namespace nonio::heidenhain_tnc
