// SPDX-License-Identifier: Apache-2.0
#include "consumer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "nonio/sdk/units.h"

namespace nonio::heidenhain {
namespace {

struct Row {
  double position = 0.0, value = 0.0;
  std::optional<double> negative;  // BACKLASH: measured in the negative direction
};

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// The word that starts in this column of the line; the table editor knows columns only.
std::string_view cell(std::string_view line, std::size_t column) {
  if (column == std::string_view::npos || column >= line.size()) return {};
  const std::string_view rest = line.substr(column);
  return rest.substr(0, std::min(rest.find(' '), rest.size()));
}

std::optional<double> real(std::string_view s) {
  if (s.empty() || (s[0] != '+' && s[0] != '-')) return {};  // the sign is always written
  double v = 0.0;
  const char* begin = s.data() + (s[0] == '+' ? 1 : 0);
  const auto r = std::from_chars(begin, s.data() + s.size(), v);
  return r.ec == std::errc() && r.ptr == s.data() + s.size() && std::isfinite(v) ? std::optional(v)
                                                                                 : std::nullopt;
}

// Start of a column by its heading.
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

Expected<void> check_number(std::string_view line, std::size_t wanted) {
  if (cell(line, 0) != std::to_string(wanted))
    return fail("row " + std::to_string(wanted) + " is numbered " + std::string(cell(line, 0)));
  return {};
}

Expected<std::vector<Row>> equidistant(const std::vector<std::string_view>& lines,
                                       const Machine& machine) {
  const auto datum = after(lines[0], "DATUM:"), distance = after(lines[0], "DISTANCE:");
  if (!datum || !distance || !(*distance > 0.0)) return fail("no DATUM and DISTANCE in line 1");
  const std::size_t column = column_of(lines[1], machine.axis);
  std::vector<Row> rows;
  for (std::size_t i = 2; i < lines.size(); ++i) {
    if (auto ok = check_number(lines[i], rows.size()); !ok)
      return tl::unexpected<Error>(ok.error());
    const auto printed = real(cell(lines[i], 8)), value = real(cell(lines[i], column));
    const double position = *datum + *distance * static_cast<double>(rows.size());
    if (!printed || !value || std::fabs(*printed - position) > 1e-4)
      return fail("line " + std::to_string(i + 1) + " is not at its place");
    rows.push_back({position, *value, {}});
  }
  return rows;
}

Expected<std::vector<Row>> listed(const std::vector<std::string_view>& lines,
                                  const Machine& machine) {
  const std::size_t position = column_of(lines[1], "AXISPOS");
  const std::size_t negative = column_of(lines[1], "BACKLASH");
  const std::size_t column = column_of(lines[1], machine.axis);
  std::vector<Row> rows;
  for (std::size_t i = 2; i < lines.size(); ++i) {
    if (lines[i] == "[END]") return rows;
    if (auto ok = check_number(lines[i], rows.size()); !ok)
      return tl::unexpected<Error>(ok.error());
    const auto x = real(cell(lines[i], position)), value = real(cell(lines[i], column));
    if (!x || !value) return fail("line " + std::to_string(i + 1) + " is not at its place");
    rows.push_back({*x, *value, real(cell(lines[i], negative))});
  }
  return fail("no [END]");
}

Expected<void> good(const std::vector<Row>& rows, const Machine& machine) {
  if (rows.size() < 2 || rows.size() > machine.points)
    return fail(std::to_string(rows.size()) + " rows, the control takes 2 to " +
                std::to_string(machine.points));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (!(rows[i].position > rows[i - 1].position)) return fail("positions do not rise");
    if (rows[i].negative.has_value() != rows[0].negative.has_value())
      return fail("BACKLASH is filled in some rows only");
  }
  return {};
}

double interpolated(const std::vector<Row>& rows, double x, bool negative) {
  const auto value = [&](const Row& r) {
    return negative ? r.negative.value_or(r.value) : r.value;
  };
  if (x <= rows.front().position) return value(rows.front());
  if (x >= rows.back().position) return value(rows.back());
  std::size_t i = 1;
  while (rows[i].position < x) ++i;
  const double t = (x - rows[i - 1].position) / (rows[i].position - rows[i - 1].position);
  return value(rows[i - 1]) + t * (value(rows[i]) - value(rows[i - 1]));
}

}  // namespace

Expected<math::Correction> load(std::string_view com, const Machine& machine) {
  const auto lines = lines_of(com);
  if (lines.size() < 4 || lines[0].rfind("BEGIN ", 0) != 0) return fail("not a .COM table");
  const bool with_datum = lines[0].find("DATUM:") != std::string_view::npos;
  auto rows = with_datum ? equidistant(lines, machine) : listed(lines, machine);
  if (!rows) return tl::unexpected<Error>(rows.error());
  if (auto ok = good(*rows, machine); !ok) return tl::unexpected<Error>(ok.error());
  const double per_si = machine.rotary ? deg_per_rad : 1e3;
  // +e: the error is taken off. Half of the backlash value in each direction; a constant that
  // the control adds to both is in no range of deviations.
  return math::Correction([rows = std::move(*rows), per_si, backlash = machine.backlash,
                           rotary = machine.rotary](double x, int direction) {
    double at = x * per_si;
    if (rotary && rows.front().position == 0.0 && rows.back().position == 360.0)
      at = std::fmod(std::fmod(at, 360.0) + 360.0, 360.0);
    const double lost = direction > 0 ? backlash / 2.0 : -backlash / 2.0;
    return (lost - interpolated(rows, at, direction < 0)) / per_si;
  });
}

Expected<double> backlash_entered(std::string_view words) {
  for (const std::string_view line : lines_of(words))
    if (const auto v = after(line, "backLash = ")) return *v;
  return fail("no line \"backLash = \"");
}

Expected<std::string> assigned(std::string_view cma, std::string_view axis) {
  const auto lines = lines_of(cma);
  if (lines.size() < 3 || lines[0].rfind("BEGIN ", 0) != 0) return fail("not a .CMA table");
  const std::size_t active = column_of(lines[1], "ACTIVE"), column = column_of(lines[1], axis);
  for (std::size_t i = 2; i < lines.size() && lines[i] != "[END]"; ++i)
    if (active == std::string_view::npos || cell(lines[i], active) == "*")
      return std::string(cell(lines[i], column));
  return std::string();
}

}  // namespace nonio::heidenhain
