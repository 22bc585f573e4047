// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/list.h"

#include <algorithm>
#include <cmath>

namespace nonio::controllers {

std::vector<Artifact> list_file(const Sheet& s, std::string_view name, Columns columns,
                                Numbered numbered) {
  const bool two = columns == Columns::both;
  const std::string unit = s.position_unit() == 25.4e-3 ? "inch" : std::string(s.job.unit());
  std::string out = comments(s.words(), "# ") + "# point position_" + unit + " entry" +
                    (two ? " entry_minus" : "") + "\n";
  const bool whole = s.value_step() == s.value_unit();
  const auto entry = [&](const std::vector<double>& v, const std::vector<std::int64_t>& steps,
                         std::size_t i) {
    return whole ? std::to_string(steps[i]) : s.entry(v[i]);
  };
  const std::size_t points = s.plus_steps.size();
  for (std::size_t number = 1; number <= points; ++number) {
    const std::size_t i = numbered == Numbered::upwards ? number - 1 : points - number;
    out += std::to_string(number) + " " + s.at(i) + " " + entry(s.plus, s.plus_steps, i);
    if (two) out += " " + (s.directions ? entry(s.minus, s.minus_steps, i) : "0");
    out += "\n";
  }
  return {{std::string(name) + "-" + s.job.stem + ".txt", std::move(out)}};
}

namespace {

Expected<void> whole_text(const Artifact& f, std::size_t points) {
  if (auto ended = ends_whole(f.name, f.bytes); !ended) return ended;
  const std::size_t at = f.bytes.find(points_said);
  if (at == std::string::npos) return {};
  const auto words = words_of(
      std::string_view(f.bytes).substr(at + std::string_view(points_said).size(), 20), " \r\n");
  const auto said = whole(words.empty() ? "" : words.front());
  if (!said || *said != static_cast<std::int64_t>(points))
    return fail(f.name + ": " + std::to_string(points) + " points, its words state " +
                std::string(words.empty() ? "nothing" : words.front()) + ": the file was cut");
  return {};
}

}  // namespace

Expected<std::vector<LoadedTable>> parse_files(const TableInput& in, const ControlTable& table,
                                               std::string_view name, const Take& take) {
  NONIO_TRY(const auto axes, known_axes(in));
  std::vector<LoadedTable> tables;
  for (const Artifact& f : in.files) {
    RawTable raw{axis_of_file(axes, f.name, std::string(name) + "-"), {}, {}};
    raw.backlash = parameter_in(f.bytes, table.backlash);
    std::size_t points = 0;
    for (const std::string_view line : lines_of(f.bytes)) {
      NONIO_TRY(const auto taken, take(line, raw));
      points += taken ? 1U : 0U;
    }
    if (points == 0) continue;
    if (auto ok = whole_text(f, points); !ok) return tl::unexpected<Error>(ok.error());
    if (raw.position.front() > raw.position.back()) {  // numbered downwards
      for (auto* column : {&raw.position, &raw.plus, &raw.minus})
        std::reverse(column->begin(), column->end());
    }
    NONIO_TRY(auto read, loaded(table, raw));
    const auto& x = read.position.front();
    const bool turn = read.rotary && x.front() == 0.0 && std::fabs(x.back() - full_turn) < 1e-9;
    if (turn && read.plus.front() == read.plus.back()) read.outside = LoadedTable::Outside::repeats;
    tables.push_back(std::move(read));
  }
  if (tables.empty()) return fail("no table of " + std::string(name) + " in it");
  return tables;
}

tl::unexpected<Error> no_point(std::string_view line) {
  return fail("not a point of a table: " + std::string(line.substr(0, 80)));
}

Expected<std::vector<LoadedTable>> parse_list(const TableInput& in, const ControlTable& table,
                                              std::string_view name, Columns columns) {
  const bool two = columns == Columns::both;
  auto tables = parse_files(in, table, name, [&](auto line, RawTable& raw) -> Expected<bool> {
    if (line.empty() || line.front() == '#') return false;
    std::vector<double> v;
    for (const auto word : words_of(line)) v.push_back(real(word).value_or(NAN));
    if (v.size() != (two ? 4U : 3U) || v[0] != static_cast<double>(raw.position.size() + 1))
      return no_point(line);
    raw.position.push_back(v[1]);
    raw.plus.push_back(v[2]);
    if (two) raw.minus.push_back(v[3]);
    return true;
  });
  if (!tables) return tables;
  for (LoadedTable& t : *tables)  // zeros for minus mean that one column applies to both directions
    if (std::all_of(t.minus.begin(), t.minus.end(), [](double v) { return v == 0.0; }))
      t.minus.clear();
  return tables;
}

std::optional<double> parameter_in(std::string_view bytes, std::string_view parameter) {
  if (parameter.empty()) return std::nullopt;
  const std::string key = std::string(parameter) + " = ";
  const std::size_t at = bytes.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  const auto words = words_of(bytes.substr(at + key.size(), 60), " \r\n");
  if (words.size() < 2 || (words[1] != "mm" && words[1] != "deg")) return std::nullopt;
  const auto value = real(words[0]);
  return value ? std::optional(*value / (words[1] == "mm" ? 1e3 : deg_per_rad)) : std::nullopt;
}

}  // namespace nonio::controllers
